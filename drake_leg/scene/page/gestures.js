// In a frame of another page the wheel and a finger scroll that page, until the picture has been
// clicked or tapped. With Ctrl the wheel zooms at once, as everywhere.
const shareGestures = (pane) => {
  "use strict";
  if (window.parent === window) return;
  const BRIEFLY = 2200; // [ms], that a hint stands
  const NOTCH = 50; // [px], from which on a step of the wheel is not a pinch on a touchpad
  const hint = Object.assign(document.createElement("p"), { id: "page-hint", hidden: true });
  hint.setAttribute("aria-hidden", "true");
  pane.append(hint);
  pane.classList.add("shared");
  let taken = false, byFinger = false, ending = 0;

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
    if (!byFinger) take(true);
    else if (!taken) event.stopPropagation();
  }, { capture: true });

  pane.addEventListener("click", () => {
    if (!byFinger) return;
    take(!taken);
    say(taken ? "One finger turns, two zoom; tap again to scroll the page" : "Tap to turn");
  });

  // The browser takes the finger to scroll with.
  pane.addEventListener("pointercancel", () => { if (byFinger && !taken) say("Tap to turn"); });

  document.documentElement.addEventListener("mouseleave", () => { if (!byFinger) take(false); });
  window.addEventListener("blur", () => take(false));
  new IntersectionObserver((entries) => {
    if (!entries.at(-1).isIntersecting) take(false);
  }).observe(pane);
};
