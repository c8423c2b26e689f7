// Replays are in the page, compressed: one is opened in its place when it is asked for, and plays.
// Where the browser cannot do that, the link leads to the replay's own file, which does.
const replays = JSON.parse(document.getElementById("replays").textContent);

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

for (const link of document.querySelectorAll("figure.replay a")) {
  link.addEventListener("click", async (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey || !window.DecompressionStream) return;
    event.preventDefault();
    const name = link.getAttribute("href").replace(/\.html.*$/, "");
    const [before, after] = JSON.parse(await inflated(replays.pages[name]));
    const frame = document.createElement("iframe");
    frame.srcdoc = before + (await inflated(replays.viewer)) + after;
    frame.title = `${link.title}, in 3D`;
    frame.addEventListener("load", () => frame.contentWindow.postMessage("play", "*"));
    link.replaceWith(frame);
    frame.focus({ preventScroll: true });
    frame.scrollIntoView({ block: "start" });
  });
}
