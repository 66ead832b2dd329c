// Draws the page's plots. Names come from logs: they reach the page as texts only, never as markup.
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const INK = "#2b333d";
  const FAINT = "#dfe3e8";
  const COLORS = { occupied: "#2563a8", free: "#4b8f5c", unobserved: "#7a7f87", seen: "#b0702a" };

  Chart.defaults.animation = false;
  Chart.defaults.color = INK;
  Chart.defaults.borderColor = FAINT;
  Chart.defaults.font.family = "system-ui, sans-serif";
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.plugins.legend.display = false;

  const grouped = (count) => count.toLocaleString("en").replaceAll(",", "\u202f");

  // Bars that lie on their side, names before them.
  function bars(id, names, values, colors, options) {
    const canvas = document.getElementById(id);
    if (!canvas) return;
    new Chart(canvas, {
      type: "bar",
      data: { labels: names, datasets: [{ data: values, backgroundColor: colors, borderColor: "#00000040", borderWidth: 1 }] },
      options: {
        indexAxis: "y",
        layout: { padding: { right: 24 } },
        plugins: { tooltip: { callbacks: { label: (item) => options.told(item.raw) } } },
        scales: {
          x: { type: options.scale, min: options.min, title: { display: true, text: options.unit }, ticks: options.ticks, grid: options.grid },
          y: { grid: { display: false }, ticks: { autoSkip: false } },
        },
      },
    });
  }

  function classes() {
    const isTen = (value) => Number.isInteger(Math.log10(value));
    bars("plot-classes", data.classes.map((c) => c[0]), data.classes.map((c) => c[1] || null), data.classes.map((c) => c[2]), {
      scale: "logarithmic",
      min: 1,
      unit: "voxels, logarithmic",
      told: (value) => `${grouped(value)} voxels`,
      grid: { color: (line) => (isTen(line.tick.value) ? FAINT : "transparent") },
      ticks: { callback: (value) => (isTen(value) ? grouped(value) : ""), autoSkip: false, maxRotation: 0 },
    });
  }

  function stages() {
    bars("plot-stages", data.stages.map((s) => s[0]), data.stages.map((s) => s[1]), "#6d8fb8", {
      scale: "linear",
      min: 0,
      unit: "seconds",
      told: (value) => `${value.toFixed(2)} s`,
      ticks: {},
    });
  }

  // A line for each state of the chosen scene.
  function alongKeyframes() {
    const select = document.getElementById("scene");
    data.scenes.forEach((scene, place) => select.add(new Option(scene.name, String(place))));
    const plots = data.states.flatMap((state, column) => {
      const canvas = document.getElementById(`plot-${state}`);
      return canvas ? [{ plot: line(canvas, COLORS[state]), column }] : [];
    });
    const show = () => {
      const { shares } = data.scenes[Number(select.value)];
      for (const { plot, column } of plots) {
        plot.data.labels = shares.map((_, place) => place + 1);
        plot.data.datasets[0].data = shares.map((row) => (row[column] === null ? null : row[column] / 1000));
        plot.update();
      }
    };
    select.addEventListener("change", show);
    if (data.scenes.length > 0) show();
  }

  function line(canvas, color) {
    return new Chart(canvas, {
      type: "line",
      data: { labels: [], datasets: [{ data: [], borderColor: color, backgroundColor: color, borderWidth: 1.5, pointRadius: 2 }] },
      options: {
        interaction: { mode: "index", intersect: false },
        plugins: { tooltip: { callbacks: { title: (items) => `keyframe ${items[0].label}`, label: (item) => `${item.raw} %` } } },
        scales: {
          x: { title: { display: true, text: "keyframe" }, grid: { display: false }, ticks: { maxRotation: 0, maxTicksLimit: 11 } },
          y: { beginAtZero: true, grace: "5%", ticks: { callback: (value) => `${Number(value.toPrecision(4))} %`, maxTicksLimit: 6 } },
        },
      },
    });
  }

  // On paper nothing can be opened.
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((one) => { one.open = true; }));

  classes();
  stages();
  alongKeyframes();
})();
