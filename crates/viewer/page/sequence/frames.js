// The frames: quantised places and tracks of vertices, and the triangles, drawn without sharing vertices, so that a triangle's
// corners each colour what is nearest to them.

class Body {
  constructor(data) {
    this.data = data;
    this.low = [Infinity, Infinity, Infinity];
    this.high = [-Infinity, -Infinity, -Infinity];
    for (const frame of data.frames) {
      for (let a = 0; a < 3; a++) {
        this.low[a] = Math.min(this.low[a], frame.low[a]);
        this.high[a] = Math.max(this.high[a], frame.low[a] + 65535 * frame.step[a]);
      }
    }
    this.middle = [0, 1, 2].map((a) => 0.5 * (this.low[a] + this.high[a]));
    // In how many frames each piece of the body is found, by any track of its colour.
    const frames = data.tracks.map(() => new Set());
    for (const track of data.tracks) for (const { frame } of track.sightings) frames[track.colourOf]?.add(frame);
    this.lasts = data.tracks.map((track) => 2 * (frames[track.colourOf]?.size ?? 0) >= data.total);
    this.radius = 0.5 * Math.hypot(...[0, 1, 2].map((a) => this.high[a] - this.low[a])) || 1;
  }

  // The corners of all triangles of a frame, three numbers each, about the middle.
  corners(frame) {
    const { position, low, step } = frame;
    const triangle = this.data.triangles[frame.triangles];
    const out = new Float32Array(3 * triangle.length);
    for (let i = 0; i < triangle.length; i++) {
      for (let a = 0; a < 3; a++) out[3 * i + a] = low[a] + step[a] * position[3 * triangle[i] + a] - this.middle[a];
    }
    return out;
  }

  // The track that stands for one in a frame: where only lasting ones are shown, the next around it whose piece of the body is found in
  // half of the frames; but what is chosen is always shown.
  shown(frame, track, lasting, chosen) {
    let t = track;
    while (lasting && t >= 0 && t !== chosen && !this.lasts[t]) {
      t = this.parent(frame, t);
    }
    return t;
  }

  // For each corner the colours of all three corners of its triangle, four bytes each.
  colours(frame, chosen, lasting) {
    const triangle = this.data.triangles[frame.triangles];
    const paint = this.data.tracks.map((_, t) => {
      const shown = this.shown(frame, t, lasting, chosen);
      const colour = shown >= 0 ? this.data.tracks[shown].colour : this.data.none;
      if (chosen < 0 || this.within(frame, t, chosen)) return colour;
      return colour.map((c, a) => Math.round(0.18 * c + 0.82 * this.data.none[a]));
    });
    const out = new Uint8Array(12 * triangle.length);
    for (let i = 0; i < triangle.length; i++) {
      const first = i - (i % 3);
      for (let k = 0; k < 3; k++) {
        const colour = paint[frame.track[triangle[first + k]]] || this.data.none;
        for (let a = 0; a < 3; a++) out[12 * i + 4 * k + a] = colour[a];
        out[12 * i + 4 * k + 3] = 255;
      }
    }
    return out;
  }

  // Whether a track is another one, or inside it, in a frame.
  within(frame, track, outer) {
    for (let t = track; t !== undefined && t >= 0; t = this.parent(frame, t)) if (t === outer) return true;
    return false;
  }

  parent(frame, track) {
    const found = frame.parents.find(([inner]) => inner === track);
    return found ? found[1] : -1;
  }

  // The track that is seen in the direction `toward` from a place; -1 for none, undefined beside the body.
  pick(frame, corners, origin, toward) {
    let best = -Infinity;
    let found;
    const sub = (p, q) => [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    const triangle = this.data.triangles[frame.triangles];
    for (let i = 0; i < triangle.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => corners.subarray(3 * (i + k), 3 * (i + k) + 3));
      const [u, v] = [sub(b, a), sub(c, a)];
      const p = cross(toward, v);
      const d = dot(u, p);
      if (Math.abs(d) < 1e-30) continue;
      const s = sub(origin, a);
      const x = dot(s, p) / d;
      const q = cross(s, u);
      const y = dot(toward, q) / d;
      const depth = dot(v, q) / d;
      if (x < 0 || y < 0 || x + y > 1 || depth <= best) continue;
      best = depth;
      const weights = [1 - x - y, x, y];
      found = frame.track[triangle[i + weights.indexOf(Math.max(...weights))]];
    }
    return found;
  }
}
