# shellcheck shell=sh disable=SC2154
# Roots of a Debian suite, for deploy/package-test. To be sourced from the project's folder by root, in a mount namespace of
# its own: the mounts end with it. $suite names the suite. $work keeps its base, tools, downloads and compiler's cache.

mirror=http://deb.debian.org/debian

inRoot() {  # root, command ...
  place=$1
  shift
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$place" "$@"
}

makeBase() {  # debootstrap makes the base once
  [ ! -e "$work/base.complete" ] || return 0
  echo "== debootstrap $suite =="
  rm -rf --one-file-system "$work/base"
  mkdir -p "$work/archives" "$work/ccache"
  log=$work/debootstrap.log
  debootstrap --variant=minbase --include=systemd,procps "$suite" "$work/base" "$mirror" >"$log" 2>&1 ||
    endWith "debootstrap $suite failed: $(tail -n 1 "$log"); all of its output is in $log"
  echo force-unsafe-io >"$work/base/etc/dpkg/dpkg.cfg.d/unsafe-io"  # a root that is lost can be made again
  printf '#!/bin/sh\nexit 101\n' >"$work/base/usr/sbin/policy-rc.d"  # no package starts its service
  chmod 755 "$work/base/usr/sbin/policy-rc.d"
  touch "$work/base.complete"
}

copyBase() {  # root
  rm -rf --one-file-system "$1"
  cp -a --reflink=auto "$work/base" "$1"
}

mountRoot() {  # root
  cp /etc/resolv.conf "$1/etc/resolv.conf"
  mount -t proc proc "$1/proc"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"  # a test opens a terminal
  mount --bind "$work/archives" "$1/var/cache/apt/archives"
}

makeTools() {  # root, packages ...: what the build needs; made again when the list of packages changes
  tools=$1
  shift
  { cat deploy/install-deps; echo "$*"; } >"$work/tools.list"
  if cmp -s "$work/tools.list" "$work/tools.complete"; then
    mountRoot "$tools"
  else
    echo "== deploy/install-deps in $suite =="
    copyBase "$tools"
    mountRoot "$tools"
    cp deploy/install-deps "$tools/root"
    inRoot "$tools" /root/install-deps --for-packages "$@" >"$work/install-deps.log" 2>&1 ||
      endWith "deploy/install-deps failed in $suite; all of its output is in $work/install-deps.log"
    cp "$work/tools.list" "$work/tools.complete"
  fi
  mkdir -p "$tools/root/.cache/ccache"
  mount --bind "$work/ccache" "$tools/root/.cache/ccache"
}
