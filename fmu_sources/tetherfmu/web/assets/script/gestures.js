// Pointer, touch and keyboard on the view: turn, zoom, lead the kite, steer it.

const TURN = 0.008; // rad for a pixel
const KEY_TURN = 0.06; // rad for a key
const STEERING_RATE = 0.12; // for a key

/** Listen to a canvas.  on : functions turn(azimuth, elevation), closer(factor), lead(x, y), steer(change); the last two say
 * whether they did anything. */
export function listen(canvas, on) {
  const fingers = new Map();
  let spread = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const distance = () => {
    const [[ax, ay], [bx, by]] = [...fingers.values()];
    return Math.hypot(ax - bx, ay - by);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
    if (fingers.size === 2) spread = distance();
    if (fingers.size === 1 && !event.shiftKey && event.button === 0) on.lead(...place(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    const now = place(event);
    if (!before) {
      if (event.pointerType === "mouse" && !event.shiftKey) on.lead(...now);
      return;
    }
    fingers.set(event.pointerId, now);
    if (fingers.size === 2) {
      const wide = distance();
      on.closer(wide / spread);
      spread = wide;
      on.turn((TURN * (before[0] - now[0])) / 2, (TURN * (now[1] - before[1])) / 2);
    } else if (event.shiftKey || event.buttons === 2 || !on.lead(...now)) {
      on.turn(TURN * (before[0] - now[0]), TURN * (now[1] - before[1]));
    }
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (window.self !== window.top && document.activeElement !== canvas) return; // it moves the page around
      event.preventDefault();
      on.closer(Math.exp(-0.0015 * event.deltaY));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const side = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const action = {
      ArrowLeft: () => (event.shiftKey || !on.steer(side * STEERING_RATE)) && on.turn(-KEY_TURN, 0),
      ArrowRight: () => (event.shiftKey || !on.steer(side * STEERING_RATE)) && on.turn(KEY_TURN, 0),
      ArrowUp: () => on.turn(0, KEY_TURN),
      ArrowDown: () => on.turn(0, -KEY_TURN),
      "+": () => on.closer(1.15),
      "-": () => on.closer(1 / 1.15),
    }[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  });
}
