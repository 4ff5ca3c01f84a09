// The pictures: the part with its measurands, the same with the cameras, and the laws of a characteristic when it is opened.
// The filter of the characteristics, and the links to the sections.
(function () {
  const text = document.getElementById("scene").textContent;
  const [light, dark] = JSON.parse(text).themes;
  const night = window.matchMedia("(prefers-color-scheme: dark)");
  const buttons = [["zoom3d", "pan3d", "orbitRotation", "tableRotation"], ["resetCameraDefault3d"]];
  const config = { displaylogo: false, responsive: true, modeBarButtons: buttons };
  const quiet = { displayModeBar: false, responsive: true };
  let printing = false;
  let drawn = [];

  // The scene as data, with the inks of the surroundings. Plotly writes into its arguments: each picture has its own.
  function fresh() {
    let themed = text;
    if (night.matches && !printing) {
      for (const ink of Object.keys(light)) themed = themed.replaceAll(`"${light[ink]}"`, `"${dark[ink]}"`);
    }
    return JSON.parse(themed);
  }
  function draw(id, picture) {
    drawn = drawn.filter((other) => other.id !== id).concat({ id, picture });
    const { data, layout, options } = picture(fresh());
    return Plotly.react(id, data, layout, options);
  }
  function closeup(scene) {
    return { data: scene.part, layout: scene.layout, options: config };
  }
  function overview(scene) {
    for (const trace of scene.part) {
      trace.showlegend = false;
      if (trace.type === "scatter3d") trace.mode = "lines"; // too small here for marks and names
    }
    return { data: scene.part.concat(scene.cameras), layout: scene.layout, options: config };
  }
  draw("closeup", closeup);
  draw("overview", overview);

  for (const law of document.querySelectorAll("details.law")) {
    law.addEventListener("toggle", () => {
      for (const half of [0, 1]) {
        const id = `${law.dataset.law}-${half}`;
        if (law.open) draw(id, (scene) => ({ ...scene.laws[law.dataset.law][half], options: quiet }));
        else drawn = drawn.filter((other) => other.id !== id);
      }
    });
  }

  function again() {
    return Promise.all(drawn.map(({ id, picture }) => draw(id, picture)));
  }
  night.addEventListener("change", again);
  for (const [event, now] of [["beforeprint", true], ["afterprint", false]]) {
    window.addEventListener(event, () => {
      printing = now;
      if (night.matches) again();
    });
  }

  for (const form of document.querySelectorAll("form.filter")) {
    const rows = [...document.querySelectorAll(`#${form.dataset.for} tbody tr`)];
    const contents = rows.map((row) => row.textContent.toLowerCase());
    const count = form.querySelector("output");
    function filter() {
      const words = form.elements.text.value.toLowerCase().split(/\s+/).filter(Boolean);
      const status = form.elements.status.value;
      let shown = 0;
      rows.forEach((row, k) => {
        const hit = (!status || row.className === status) && words.every((word) => contents[k].includes(word));
        row.hidden = !hit;
        shown += hit;
      });
      count.textContent = shown === rows.length ? `${rows.length} characteristics` : `${shown} of ${rows.length} characteristics`;
    }
    form.addEventListener("input", filter);
    form.addEventListener("submit", (event) => event.preventDefault());
    filter();
  }

  const links = document.querySelector("nav");
  for (const heading of document.querySelectorAll("h2[id]")) {
    const link = document.createElement("a");
    link.href = `#${heading.id}`;
    link.textContent = heading.textContent;
    links.append(link);
  }
})();
