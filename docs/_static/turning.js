// One folded state that can be turned: facets with a depth buffer on a canvas, no library.
(function () {
  const PAPER = [[236, 196, 140], [132, 168, 208]];  // upper side, lower side
  const LINES = { M: [192, 32, 38], V: [28, 84, 176], B: [60, 60, 60] };
  const LIGHT = [0.28, 0.47, 0.84];

  function show(box, data) {
    const canvas = box.querySelector("canvas"), caption = box.querySelector("[data-caption]");
    let state = 0, yaw = 0, pitch = 0, turning = !matchMedia("(prefers-reduced-motion: reduce)").matches, last = null;

    function turned(p, view) {  // the state's own view, then by hand
      let [x, y, z] = view.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
      [x, z] = [x * Math.cos(yaw) + z * Math.sin(yaw), z * Math.cos(yaw) - x * Math.sin(yaw)];
      [y, z] = [y * Math.cos(pitch) - z * Math.sin(pitch), y * Math.sin(pitch) + z * Math.cos(pitch)];
      return [x, y, z];
    }

    function draw() {
      const scale = Math.min(2, 1.5 * (window.devicePixelRatio || 1));
      const w = canvas.width = Math.round(canvas.clientWidth * scale);
      const h = canvas.height = Math.round(canvas.clientHeight * scale);
      if (!w || !h) return;
      const context = canvas.getContext("2d"), image = context.createImageData(w, h), px = image.data;
      const depth = new Float32Array(w * h).fill(-1e9), one = data.states[state];
      const unit = 0.68 * Math.min(w, h) / one.size;
      const at = one.corners.map((p) => {
        const [x, y, z] = turned(p, one.view);
        return [w / 2 + unit * x, h / 2 - unit * y, unit * z];
      });
      for (const facet of data.facets) {
        for (let k = 1; k + 1 < facet.length; k++) triangle(at[facet[0]], at[facet[k]], at[facet[k + 1]]);
      }
      for (const [a, b, kind] of data.lines) line(at[a], at[b], LINES[kind === "B" ? "B" : one.letters[kind]] , scale);
      context.putImageData(image, 0, 0);

      function put(x, y, z, c) {
        if (x < 0 || y < 0 || x >= w || y >= h) return;
        const i = y * w + x;
        if (z <= depth[i]) return;
        depth[i] = z;
        px[4 * i] = c[0]; px[4 * i + 1] = c[1]; px[4 * i + 2] = c[2]; px[4 * i + 3] = 255;
      }
      function triangle(p, q, r) {
        const u = [q[0] - p[0], q[1] - p[1], q[2] - p[2]], v = [r[0] - p[0], r[1] - p[1], r[2] - p[2]];
        // y of the screen points down: the upper side faces the viewer where this is positive
        const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        const area = n[2], length = Math.hypot(...n) || 1;
        if (Math.abs(area) < 1e-6) return;
        const upper = area < 0, s = upper ? -1 : 1;
        const lit = 0.62 + 0.38 * Math.max(0, s * (n[0] * LIGHT[0] - n[1] * LIGHT[1] + n[2] * LIGHT[2]) / length);
        const colour = PAPER[upper ? 0 : 1].map((c) => c * lit);
        const x0 = Math.floor(Math.min(p[0], q[0], r[0])), x1 = Math.ceil(Math.max(p[0], q[0], r[0]));
        const y0 = Math.floor(Math.min(p[1], q[1], r[1])), y1 = Math.ceil(Math.max(p[1], q[1], r[1]));
        for (let y = Math.max(0, y0); y <= Math.min(h - 1, y1); y++) {
          for (let x = Math.max(0, x0); x <= Math.min(w - 1, x1); x++) {
            const b = ((x - p[0]) * v[1] - (y - p[1]) * v[0]) / area, c = (u[0] * (y - p[1]) - u[1] * (x - p[0])) / area;
            if (b >= -1e-9 && c >= -1e-9 && b + c <= 1 + 1e-9) put(x, y, p[2] + b * u[2] + c * v[2], colour);
          }
        }
      }
      function line(p, q, colour, width) {
        const steps = Math.ceil(Math.hypot(q[0] - p[0], q[1] - p[1])) + 1, r = 1.1 * width;
        for (let i = 0; i <= steps; i++) {
          const t = i / steps, x = p[0] + t * (q[0] - p[0]), y = p[1] + t * (q[1] - p[1]), z = p[2] + t * (q[2] - p[2]);
          for (let dx = -Math.ceil(r); dx <= r; dx++) {
            for (let dy = -Math.ceil(r); dy <= r; dy++) {
              if (dx * dx + dy * dy <= r * r) put(Math.round(x + dx), Math.round(y + dy), z + 2 * width, colour);
            }
          }
        }
      }
    }

    function frame(now) {
      if (turning && last !== null) yaw += 0.0004 * Math.min(60, now - last);
      last = now;
      draw();
      if (turning) requestAnimationFrame(frame);
    }
    function stop() { turning = false; }
    canvas.addEventListener("pointerdown", (event) => { stop(); canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      yaw += 0.01 * event.movementX;
      pitch = Math.max(-1.5, Math.min(1.5, pitch + 0.01 * event.movementY));
      draw();
    });
    canvas.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!way) return;
      event.preventDefault(); stop(); yaw += 0.1 * way; draw();
    });
    const buttons = [...box.querySelectorAll("button")];
    function choose(k) {
      state = k; yaw = pitch = 0;
      buttons.forEach((button, i) => button.setAttribute("aria-pressed", i === k));
      caption.textContent = data.states[k].caption;
      draw();
    }
    buttons.forEach((button, k) => button.addEventListener("click", () => choose(k)));
    addEventListener("resize", draw);
    choose(0);
    requestAnimationFrame(frame);
  }

  for (const box of document.querySelectorAll(".turning")) {
    show(box, JSON.parse(box.querySelector("script[type='application/json']").textContent));
  }
})();
