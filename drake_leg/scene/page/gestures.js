// In a frame of another page the wheel and a finger scroll that page, until the picture has been
// clicked or tapped. With Ctrl the wheel zooms at once, as everywhere.
const shareGestures = (pane) => {
  "use strict";
  if (window.parent === window) return;
  const BRIEFLY = 2200; // [ms], that a hint stands
  const NOTCH = 50; // [px], from which on a step of the wheel is not a pinch on a touchpad
  const STILL = 10, QUICK = 500; // [px, ms]: a finger that moves or stays longer does not tap
  const hint = Object.assign(document.createElement("p"), { id: "page-hint", hidden: true });
  hint.setAttribute("aria-hidden", "true");
  pane.append(hint);
  pane.classList.add("shared");
  let taken = false, byFinger = false, ending = 0, finger = null, released = -Infinity;

  function say(words) {
    hint.textContent = words;
    hint.hidden = false;
    clearTimeout(ending);
    ending = setTimeout(() => { hint.hidden = true; }, BRIEFLY);
  }

  function take(on) {
    if (on !== taken) hint.hidden = true;
    taken = on;
    pane.classList.toggle("taken", taken);
  }

  pane.addEventListener("wheel", (event) => {
    if (taken || !event.isTrusted) return;
    if (!event.ctrlKey && !event.metaKey) {
      event.stopPropagation();
      say("Click into the picture, or hold Ctrl, to zoom");
    } else if (event.deltaMode !== 0 || Math.abs(event.deltaY) >= NOTCH) {
      // Without Ctrl: the viewer would take it for a pinch, and zoom ten times as far.
      const { clientX, clientY, deltaY, deltaMode } = event;
      const plain = { clientX, clientY, deltaY, deltaMode, bubbles: true };
      event.preventDefault();
      event.stopPropagation();
      event.target.dispatchEvent(new WheelEvent("wheel", plain));
    }
  }, { capture: true, passive: false });

  pane.addEventListener("pointerdown", (event) => {
    byFinger = event.pointerType === "touch";
    finger = byFinger && event.isPrimary ? event : null;
    if (!byFinger) take(true);
    else if (!taken) event.stopPropagation();
  }, { capture: true });

  // A tap that ends the turning may make no click: some browsers take it for the end of a fling.
  pane.addEventListener("pointerup", (event) => {
    if (!taken || !finger || event.pointerId !== finger.pointerId) return;
    const moved = Math.hypot(event.clientX - finger.clientX, event.clientY - finger.clientY);
    if (moved > STILL || event.timeStamp - finger.timeStamp > QUICK) return;
    take(false);
    say("Tap to turn");
    released = event.timeStamp;
  }, { capture: true });

  pane.addEventListener("click", (event) => {
    if (!byFinger || event.timeStamp - released < QUICK) return;
    take(true);
    say("One finger turns, two zoom; tap again to scroll the page");
  });

  // The browser takes the finger to scroll with.
  pane.addEventListener("pointercancel", () => { if (byFinger && !taken) say("Tap to turn"); });

  document.documentElement.addEventListener("mouseleave", () => { if (!byFinger) take(false); });
  window.addEventListener("blur", () => take(false));
  new IntersectionObserver((entries) => {
    if (!entries.at(-1).isIntersecting) take(false);
  }).observe(pane);
};
