// SPDX-License-Identifier: MIT
// The user's own settings. The browser keeps them; nothing of the stream is kept.

const kName = 'hapticast';

/// Returns the kept settings, or the default ones.
export function loadSettings() {
  const settings =
      {view: null, panel: null, sound: false, rumble: true, vibration: true, letters: true};
  try {
    const kept = JSON.parse(localStorage.getItem(kName) ?? '{}');
    for (const name of Object.keys(settings)) {
      const isKnown = name === 'view' ? ['picture', 'relief', 'both'].includes(kept[name]) :
                                        typeof kept[name] === 'boolean';
      if (isKnown) settings[name] = kept[name];
    }
  } catch {
    // The browser keeps nothing, or the text is damaged: begin with the defaults.
  }
  return settings;
}

export function keepSettings(settings) {
  try {
    localStorage.setItem(kName, JSON.stringify(settings));
  } catch {
    // A private window: the settings last as long as the page.
  }
}

/// Returns {token, originKeys, name} of the link's fragment and removes the token from the address bar.
export function readFragment() {
  const parts = location.hash.slice(1).split('&').filter(Boolean).map(part => {
    const at = part.indexOf('=');
    const [name, value] = at < 0 ? [part, ''] : [part.slice(0, at), part.slice(at + 1)];
    try {
      return [name, decodeURIComponent(value)];
    } catch {
      return [name, value];
    }
  });
  const token = parts.findLast(([name]) => name === 'token')?.[1] ?? '';
  const name = parts.findLast(([key]) => key === 'name')?.[1] ?? '';
  // A key that is missing or damaged accepts no server.
  const originKeys =
      parts.filter(([name]) => name === 'origin-key').map(([, value]) => value || 'none');
  if (token) {
    const rest =
        parts.filter(([name]) => name !== 'token').map(([name, value]) => `${name}=${value}`);
    history.replaceState(
        null, '', location.pathname + (rest.length > 0 ? '#' + rest.join('&') : ''));
  }
  return {token, originKeys, name};
}
