/* The page of a report: tables that go on at a side, and one view for all its scenes. MIT licence, as slopekit. */
(function () {
  "use strict";
  // tables that go on at a side say so
  function sides() {
    document.querySelectorAll(".wide").forEach(function (wide) {
      var said = wide.nextElementSibling, own = said && said.classList.contains("aside");
      if (own) { said.remove(); }
      if (wide.scrollWidth > wide.clientWidth + 1) {
        said = document.createElement("p");
        said.className = "aside screen"; said.textContent = "Wider than the screen: move it sideways.";
        wide.parentNode.insertBefore(said, wide.nextSibling);
      }
    });
  }
  window.addEventListener("resize", sides);
  sides();

  // -- one view, and the places of scenes where it may be: memory holds one scene -----------------------------------
  var view = document.getElementById("view");
  if (!view) { return; }
  var places = Array.prototype.slice.call(document.querySelectorAll(".view-place"));
  var fresh = view.cloneNode(true), stop = function () {};
  function say(text) { var p = document.getElementById("view-none"); p.textContent = text; p.hidden = false; }
  function goTo(place) {  // true where the scene is seen
    stop();
    stop = function () {};
    places.forEach(function (other) { other.classList.toggle("active", other === place); });
    var next = fresh.cloneNode(true);
    view.parentNode.removeChild(view);
    place.insertBefore(next, place.firstChild);
    view = next;
    var id = place.getAttribute("data-view"), nth = id === "1" ? "" : "-" + id, shown = slopekitView(view, say);
    if (!shown.works) { return false; }
    shown.show(JSON.parse(document.getElementById("view-data" + nth).textContent));
    function keep() {  // what is printed is what was looked at last
      var still = document.getElementById("view-still" + nth), below = document.getElementById("view-still" + nth + "-legend");
      still.src = shown.picture().toDataURL("image/png"); still.hidden = false; still.parentNode.hidden = false;
      below.textContent = "";
      Array.prototype.forEach.call(document.getElementById("view-legend").childNodes, function (part) {
        below.appendChild(part.cloneNode(true));
      });
    }
    keep();
    window.addEventListener("beforeprint", keep);
    stop = function () { keep(); window.removeEventListener("beforeprint", keep); shown.stop(); };
    return true;
  }
  places.forEach(function (place) {
    place.querySelector(".turn").addEventListener("click", function () {
      goTo(place);
      view.querySelector("canvas").focus({ preventScroll: true });
    });
  });
  // the first last: each is seen once, and leaves its picture
  places.slice().reverse().every(goTo);
})();
