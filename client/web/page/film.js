// SPDX-License-Identifier: MIT
// Pictures and reliefs by media time. The force belongs to play time, which is some 100 ms behind
// the newest picture, so the page shows the picture that is nearest to play time. Pictures wait as
// JPEG. Only the picture that will be shown next is decoded: the one of play time at the drawing
// after its decoding. So a slow browser skips pictures and does not fall behind.

const kHeld_ms = 3000;  // longest playout delay that the page follows
const kJump_ms = 1000;  // a media time so far back belongs to another run of the server
const kMostDecodings = 2;

class TimedList {
  items = [];

  /// Adds an item in the order of its time and forgets old ones.
  add(item, forget) {
    const newest = this.items.at(-1);
    if (newest && item.media_ms < newest.media_ms - kJump_ms) this.clear(forget);
    let at = this.items.length;
    while (at > 0 && this.items[at - 1].media_ms > item.media_ms) --at;
    this.items.splice(at, 0, item);
    while (this.items[0].media_ms < item.media_ms - kHeld_ms) forget(this.items.shift());
  }

  clear(forget) {
    this.items.forEach(forget);
    this.items = [];
  }

  /// Returns the usable item nearest to a time; null without one.
  nearest(play_ms, isUsable) {
    let best = null;
    for (let i = this.items.length - 1; i >= 0; --i) {
      const item = this.items[i];
      if (!isUsable(item)) continue;
      if (best && Math.abs(item.media_ms - play_ms) >= Math.abs(best.media_ms - play_ms)) break;
      best = item;
    }
    return best;
  }
}

export class Film {
  pictures = new TimedList();
  reliefs = new TimedList();
  shownPicture = null;
  shownReliefs = null;
  decode_ms = 10;  // average duration of a decoding
  step_ms = 16;    // average advance of play time from one drawing to the next
  before_ms = 0;   // play time of the drawing before
  decodings = 0;
  shown = 0;  // pictures so far

  addPicture(media_ms, jpeg) {
    this.pictures.add({media_ms, jpeg, bitmap: null, asked: false}, item => this.release(item));
  }

  addReliefs(media_ms, objects) { this.reliefs.add({media_ms, objects}, () => {}); }

  clear() {
    this.pictures.clear(item => this.release(item));
    this.reliefs.clear(() => {});
  }

  /// Selects what belongs to play time (null: the newest). Returns which of both have changed.
  select(play_ms) {
    const time_ms = play_ms ?? Infinity;
    this.decodeNext(time_ms);
    const picture =
        this.choose(this.pictures, time_ms, item => item.bitmap !== null, this.shownPicture);
    // The picture covers the relief: both are of one moment, even where drawing is slow.
    const relief_ms = picture?.media_ms ?? time_ms;
    const reliefs = this.choose(this.reliefs, relief_ms, () => true, this.shownReliefs);
    const changed = {
      picture: picture !== this.shownPicture,
      reliefs: reliefs !== this.shownReliefs
    };
    const before = this.shownPicture;
    this.shownPicture = picture;
    this.shownReliefs = reliefs;
    if (changed.picture) {
      ++this.shown;
      if (before) this.release(before);
      for (const item of this.pictures.items)
        if (item.media_ms < picture.media_ms) this.release(item);
    }
    return changed;
  }

  choose(list, time_ms, isUsable, shown) {
    if (time_ms === Infinity) return list.items.findLast(isUsable) ?? shown;
    const found = list.nearest(time_ms, isUsable);
    if (!found || !shown) return found ?? shown;
    // A pause may outlast what is held: what is shown then stays.
    return Math.abs(shown.media_ms - time_ms) <= Math.abs(found.media_ms - time_ms) ? shown : found;
  }

  /// Returns how far play time will be ahead at the drawing that can show a picture decoded now.
  computeAhead_ms(time_ms) {
    const advance_ms = time_ms - this.before_ms;
    this.before_ms = time_ms;
    if (!(advance_ms > 0 && advance_ms < kJump_ms)) return 0;  // a pause, or a jump
    this.step_ms += 0.1 * (advance_ms - this.step_ms);
    return this.step_ms * Math.ceil(this.decode_ms / this.step_ms);
  }

  decodeNext(time_ms) {
    const item = time_ms === Infinity ?
        this.pictures.items.at(-1) :
        this.pictures.nearest(time_ms + this.computeAhead_ms(time_ms), () => true);
    if (!item || item.asked || this.decodings >= kMostDecodings) return;
    item.asked = true;
    ++this.decodings;
    const begin_ms = performance.now();
    createImageBitmap(new Blob([item.jpeg], {type: 'image/jpeg'}))
        .then(
            bitmap => {
              this.decode_ms += 0.1 * (performance.now() - begin_ms - this.decode_ms);
              if (item.asked)
                item.bitmap = bitmap;
              else
                bitmap.close();
            },
            () => {})  // no picture is shown
        .finally(() => --this.decodings);
  }

  /// Frees the decoded picture, unless the page shows it.
  release(item) {
    item.asked = false;
    if (item === this.shownPicture || !item.bitmap) return;
    item.bitmap.close();
    item.bitmap = null;
  }
}
