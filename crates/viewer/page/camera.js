// An orthographic camera that turns about the shape's up axis, shared by all shapes. Its azimuth counts from each shape's front.

// Azimuth and elevation of the views that keys choose: front, side, back, top, and the first one.
const VIEWS = { 1: [0, 0], 2: [90, 0], 3: [180, 0], 4: [0, 90], 0: [35, 12] };

class Camera {
  constructor(up) {
    this.up = up;
    this.look(...VIEWS[0]);
  }

  look(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
    this.zoom = 1;
    this.shift = [0, 0];
  }

  turn(dx, dy) {
    this.azimuth = (this.azimuth - dx) % 360;
    this.elevation = Math.min(90, Math.max(-90, this.elevation + dy));
  }

  // Zooms so that the point (x, y), in half heights from the centre, stays where it is.
  zoomAt(factor, x, y) {
    const zoom = Math.min(60, Math.max(0.2, this.zoom * factor));
    const real = zoom / this.zoom;
    this.shift = [x + (this.shift[0] - x) * real, y + (this.shift[1] - y) * real];
    this.zoom = zoom;
  }

  move(dx, dy) {
    this.shift = [this.shift[0] + dx, this.shift[1] + dy];
  }

  // Rows: picture right, picture up, towards the viewer. `front` is the azimuth of a shape's front among the file's axes.
  axes(front = 0) {
    const [e, a] = [this.elevation, this.azimuth + front].map((d) => (d * Math.PI) / 180);
    const [right, up, toward] =
      this.up === "z" ? [[1, 0, 0], [0, 0, 1], [0, -1, 0]] : [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const sum = (p, u, q, v) => [0, 1, 2].map((i) => p * u[i] + q * v[i]);
    const level = sum(Math.cos(a), toward, Math.sin(a), right);
    const across = sum(Math.cos(a), right, -Math.sin(a), toward);
    return [across, sum(Math.cos(e), up, -Math.sin(e), level), sum(Math.cos(e), level, Math.sin(e), up)];
  }
}
