// Moves the robot through the poses of the motion.
if (stage) (() => {
  "use strict";
  const { data, element } = stage;
  const scrub = element("replay-scrub"), play = element("replay-play");
  const clock = element("replay-clock"), speed = element("replay-speed");
  const STEP = 0.1; // [s], of an arrow key

  // For each moment and each frame x, y, z [m] and the quaternion w, x, y, z.
  const bytes = Uint8Array.from(atob(data.poses), (letter) => letter.charCodeAt(0));
  const poses = new Float32Array(bytes.buffer);
  const frames = data.paths.length;
  const moments = poses.length / (7 * frames);

  function between(moment, share, frame) {
    const now = 7 * (moment * frames + frame);
    const next = Math.min(moment + 1, moments - 1) * 7 * frames + 7 * frame;
    const pose = new Array(7);
    let dot = 0;
    for (let i = 3; i < 7; i++) dot += poses[now + i] * poses[next + i];
    const sign = dot < 0 ? -1 : 1;
    for (let i = 0; i < 7; i++) {
      pose[i] = (1 - share) * poses[now + i] + (i < 3 ? 1 : sign) * share * poses[next + i];
    }
    return pose;
  }

  const showFooting = data.footing ? makeWalked(data, stage) : () => {};

  let time = 0, playing = false, before = null;

  function show(moment) {
    time = Math.min(Math.max(moment, 0), data.duration);
    const place = Math.min(time * data.rate, moments - 1);
    const whole = Math.floor(place);
    stage.place(data.paths.map((_, frame) => between(whole, place - whole, frame)));
    showFooting(whole, place - whole);
    scrub.value = time;
    clock.textContent = `${time.toFixed(2)} of ${data.duration.toFixed(2)} s`;
    scrub.setAttribute("aria-valuetext", clock.textContent);
  }

  function setPlaying(wanted) {
    playing = wanted && data.duration > 0;
    if (playing && time >= data.duration) show(0);
    before = null;
    play.textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    if (before !== null) show(time + ((now - before) / 1000) * Number(speed.value));
    before = now;
    if (time >= data.duration) setPlaying(false);
    else requestAnimationFrame(tick);
  }

  function scrubTo(moment) {
    setPlaying(false);
    show(moment);
  }

  play.addEventListener("click", () => setPlaying(!playing));
  scrub.addEventListener("input", () => scrubTo(Number(scrub.value)));
  document.addEventListener("keydown", (event) => {
    if (stage.isTyped(event)) return;
    const actions = {
      ArrowLeft: () => scrubTo(time - STEP),
      ArrowRight: () => scrubTo(time + STEP),
      Home: () => scrubTo(0),
      End: () => scrubTo(data.duration),
    };
    if (!event.target.closest("button, summary")) actions[" "] = () => setPlaying(!playing);
    if (!(event.key in actions)) return;
    event.preventDefault();
    actions[event.key]();
  });

  // A page that holds this one asks for it with a message, a link with its ending.
  window.addEventListener("message", (event) => {
    if (event.source === window.parent && event.data === "play") setPlaying(true);
  });

  show(0);
  if (location.hash === "#play") setPlaying(true);
})();
