// Two pictures of one scene: the part with its gauges, and the same with the cameras.
(function () {
  const text = document.getElementById("scene").textContent;
  const buttons = [["zoom3d", "pan3d", "orbitRotation", "tableRotation"], ["resetCameraDefault3d"]];
  const config = { displaylogo: false, responsive: true, modeBarButtons: buttons };
  function draw(id, traces) {
    const scene = JSON.parse(text); // Plotly writes into its arguments: each picture gets its own copy
    Plotly.newPlot(id, traces(scene), scene.layout, config);
  }
  draw("closeup", (scene) => scene.part);
  draw("overview", (scene) => {
    for (const trace of scene.part) {
      trace.showlegend = false;
      if (trace.type === "scatter3d") trace.mode = "lines"; // too small here for marks and names
    }
    return scene.part.concat(scene.cameras);
  });
})();
