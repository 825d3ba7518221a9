/* The widget of a notebook: a scene that turns. slopekitView stands before this text. */
export default {
  render({ model, el }) {
    const box = document.createElement("div");
    box.className = "slopekit-view";
    box.style.setProperty("--view-height", "420px");
    el.appendChild(box);
    const view = slopekitView(box), draw = () => view.show(model.get("scene"));
    model.on("change:scene", draw);
    draw();
    return () => { model.off("change:scene", draw); view.stop(); };
  },
};
