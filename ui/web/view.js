/* The camera: where it looks, and how dragging turns it. */

const STEEPEST = 0.99; // sine of the angle to the horizon
const NARROWEST = Math.tan((5 * Math.PI) / 180);
const WIDEST = Math.tan((65 * Math.PI) / 180);

/* eye (3) [m], axes [right, down, forward] in the world; half_width: tangent of half the angle of view. */
export class View {
  constructor({ eye, axes, half_width: halfWidth }) {
    Object.assign(this, { eye, axes, halfWidth });
  }

  /* (x, y, 1), x and y from −1 to 1 -> a ray in the world; three rows. */
  worldFromRay(aspect) {
    const [right, down, forward] = this.axes;
    const height = this.halfWidth / aspect;
    return [0, 1, 2].map((k) => [this.halfWidth * right[k], -height * down[k], forward[k]]);
  }

  /* Four rows. near, far [m]. */
  clipFromWorld(aspect, near, far) {
    const [right, down, forward] = this.axes;
    const row = (axis, scale) => [...axis.map((v) => v * scale), -scale * dot(axis, this.eye)];
    const depth = row(forward, 1);
    const slope = (far + near) / (far - near);
    return [
      row(right, 1 / this.halfWidth),
      row(down, -aspect / this.halfWidth),
      depth.map((v, k) => slope * v - (k === 3 ? (2 * far * near) / (far - near) : 0)),
      depth,
    ];
  }

  /* Turn as if the picture were dragged by parts of its width. */
  drag(across, down) {
    const angle = 2 * Math.atan(this.halfWidth);
    this.turn([0, 0, 1], across * angle);
    const before = this.axes;
    this.turn(this.axes[0], down * angle);
    if (Math.abs(this.axes[2][2]) > STEEPEST) {
      this.axes = before;
    }
  }

  zoom(factor) {
    this.halfWidth = Math.min(Math.max(this.halfWidth * factor, NARROWEST), WIDEST);
  }

  turn(about, angle) {
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    this.axes = this.axes.map((axis) => {
      const side = cross(about, axis);
      const along = dot(about, axis) * (1 - cosine);
      return axis.map((v, k) => v * cosine + side[k] * sine + about[k] * along);
    });
  }
}

/* Drag with mouse or finger, zoom with the wheel; changed() after each. */
export function control(canvas, view, changed) {
  let last; // where the pointer was; phones of before 2023 have no movementX
  canvas.addEventListener("pointerdown", (event) => {
    if (event.isPrimary) {
      canvas.setPointerCapture(event.pointerId);
      last = event;
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.isPrimary && canvas.hasPointerCapture(event.pointerId)) {
      const [across, down] = [event.clientX - last.clientX, event.clientY - last.clientY];
      view.drag(across / canvas.clientWidth, down / canvas.clientWidth);
      last = event;
      changed();
    }
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    view.zoom(Math.exp(event.deltaY / 1000));
    changed();
  }, { passive: false });
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
