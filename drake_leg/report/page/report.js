// A replay is 2.4 MB of its own: it is opened in its place on the page when it is asked for.
for (const link of document.querySelectorAll("figure.replay a")) {
  link.addEventListener("click", (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    const frame = document.createElement("iframe");
    frame.src = link.getAttribute("href");
    frame.title = `${link.title}, in 3D`;
    link.replaceWith(frame);
    frame.focus();
  });
}
