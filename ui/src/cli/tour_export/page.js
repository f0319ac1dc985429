"use strict";
(() => {
  const tour = JSON.parse(document.getElementById("tour").textContent);
  const element = (id) => document.getElementById(id);
  const [canvas, flat, links, message, label] = ["picture", "flat", "links", "message", "name"].map(element);
  const [minFov, maxFov] = [0.3, 2.0];
  const options = { antialias: false, alpha: false };
  const gl = canvas.getContext("webgl2", options) || canvas.getContext("webgl", options);
  let current = -1, longitude = 0, latitude = 0, fov = 1.2;
  let program = null, isDrawn = false;

  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
  const wrap = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

  const say = (text) => {
    message.textContent = text;
    message.hidden = text === "";
  };

  const vertexSource = `
    attribute vec2 corner;
    varying vec2 place;
    void main() { place = corner; gl_Position = vec4(corner, 0.0, 1.0); }`;
  // The direction through a point of the screen, turned up and to the side, as a point of the
  // panorama.
  const fragmentSource = `
    #ifdef GL_FRAGMENT_PRECISION_HIGH
    precision highp float;
    #else
    precision mediump float;
    #endif
    varying vec2 place;
    uniform vec2 tangent;
    uniform vec2 look;
    uniform sampler2D picture;
    const float PI = 3.14159265358979;
    void main() {
      vec3 d = vec3(place * tangent, 1.0);
      float c = cos(look.y), s = sin(look.y);
      d = vec3(d.x, d.y * c + d.z * s, d.z * c - d.y * s);
      float turn = (look.x + atan(d.x, d.z)) / (2.0 * PI) + 0.5;
      float rise = atan(d.y, length(d.xz)) / PI;
      gl_FragColor = vec4(texture2D(picture, vec2(fract(turn), 0.5 - rise)).rgb, 1.0);
    }`;

  function compile(kind, source) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    return shader;
  }

  function prepare() {
    const made = gl.createProgram();
    gl.attachShader(made, compile(gl.VERTEX_SHADER, vertexSource));
    gl.attachShader(made, compile(gl.FRAGMENT_SHADER, fragmentSource));
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
      return null;
    }
    gl.useProgram(made);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    // One triangle covers the screen.
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    const corner = gl.getAttribLocation(made, "corner");
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 2, gl.FLOAT, false, 0, 0);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    return { tangent: gl.getUniformLocation(made, "tangent"), look: gl.getUniformLocation(made, "look") };
  }

  /** Returns an image that fits into the memory of the graphics card. */
  function fitting(image) {
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (image.naturalWidth <= most) {
      return image;
    }
    const small = document.createElement("canvas");
    [small.width, small.height] = [most, most / 2];
    small.getContext("2d").drawImage(image, 0, 0, small.width, small.height);
    return small;
  }

  function upload(image) {
    const isPower = (side) => (side & (side - 1)) === 0;
    const source = fitting(image);
    const repeats = gl instanceof (window.WebGL2RenderingContext || Object) || isPower(source.width);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, repeats ? gl.REPEAT : gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, gl.RGB, gl.UNSIGNED_BYTE, source);
  }

  function draw() {
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, side));
    [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
    const up = Math.tan(fov / 2), across = (up * width) / height;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.uniform2f(program.tangent, across, up);
    gl.uniform2f(program.look, longitude, latitude);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    for (const button of links.children) {
      place(button, across, up);
    }
    turnCone(width / height);
    isDrawn = false;
  }

  /** Draws before the screen is refreshed, once for all changes until then. */
  function redraw() {
    if (program && !isDrawn) {
      isDrawn = true;
      window.requestAnimationFrame(draw);
    }
  }

  /** Moves a link to its direction on the screen, or hides it. */
  function place(button, across, up) {
    const [, turn, rise] = tour.views[current].links[Number(button.dataset.link)];
    const flatten = Math.cos(rise), side = turn - longitude;
    const [x, y, z] = [Math.sin(side) * flatten, Math.sin(rise), Math.cos(side) * flatten];
    const [c, s] = [Math.cos(latitude), Math.sin(latitude)];
    const depth = z * c + y * s;
    const [left, top] = [x / depth / across, (y * c - z * s) / depth / up];
    button.hidden = depth < 0.01 || Math.abs(left) > 1 || Math.abs(top) > 1;
    button.style.left = `${50 + 50 * left}%`;
    button.style.top = `${50 - 50 * top}%`;
  }

  /** Shows on the plan where the viewer looks. */
  function turnCone(aspect) {
    const dot = document.querySelector(`#plan circle[data-view="${current}"]`);
    const half = Math.atan(Math.tan(fov / 2) * aspect);
    // Headings turn left from -Z; on the plan x is to the right and z downwards.
    const heading = tour.views[current].yaw - longitude;
    const [x, y] = [Number(dot.getAttribute("cx")), Number(dot.getAttribute("cy"))];
    const tip = (angle) => `${x - 16 * Math.sin(angle)} ${y - 16 * Math.cos(angle)}`;
    element("cone").setAttribute("d", `M${x} ${y}L${tip(heading + half)}L${tip(heading)}L${tip(heading - half)}Z`);
  }

  function showLinks() {
    links.replaceChildren();
    tour.views[current].links.forEach(([to, , , distance], number) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = tour.views[to].name;
      button.title = `${tour.views[to].name}, ${distance.toFixed(1)} m`;
      button.dataset.link = number;
      // Nearer views lie over farther ones.
      button.style.zIndex = Math.max(1, 1000 - Math.round(distance));
      button.hidden = true;
      button.addEventListener("click", () => go(to, true));
      links.append(button);
    });
  }

  function mark() {
    for (const button of document.querySelectorAll("nav button")) {
      const isCurrent = Number(button.dataset.view) === current;
      isCurrent ? button.setAttribute("aria-current", "true") : button.removeAttribute("aria-current");
    }
    for (const dot of document.querySelectorAll("#plan circle")) {
      dot.classList.toggle("current", Number(dot.dataset.view) === current);
    }
    label.textContent = tour.views[current].name;
  }

  /** Goes to a view: in the direction in which the viewer looks, or in that of the view. */
  function go(index, keepsHeading) {
    const view = tour.views[index];
    if (!view || index === current) {
      return;
    }
    if (keepsHeading && current >= 0) {
      longitude = wrap(longitude - tour.views[current].yaw + view.yaw);
    } else {
      [longitude, latitude, fov] = [0, view.pitch, clamp(view.fov, minFov, maxFov)];
    }
    current = index;
    document.body.dataset.view = index;
    document.body.dataset.ready = "false";
    history.replaceState(null, "", `#${index + 1}`);
    mark();
    links.replaceChildren();
    load(view, index);
  }

  function load(view, index) {
    const image = new Image();
    image.onload = () => {
      if (index !== current) {
        return;
      }
      if (program) {
        upload(image);
        showLinks();
        redraw();
      } else {
        flat.src = image.src;
      }
      document.body.dataset.ready = "true";
    };
    image.onerror = () => say(`The panorama of ${view.name} is damaged.`);
    image.src = view.picture;
  }

  function look(right, up) {
    longitude = wrap(longitude + right);
    latitude = clamp(latitude + up, -Math.PI / 2, Math.PI / 2);
    redraw();
  }

  function zoom(factor) {
    fov = clamp(fov * factor, minFov, maxFov);
    redraw();
  }

  const keys = {
    ArrowLeft: () => look(-fov / 12, 0),
    ArrowRight: () => look(fov / 12, 0),
    ArrowUp: () => look(0, fov / 12),
    ArrowDown: () => look(0, -fov / 12),
    "+": () => zoom(0.9),
    "=": () => zoom(0.9),
    "-": () => zoom(1 / 0.9),
    Home: () => look(-longitude, tour.views[current].pitch - latitude),
  };

  const pointers = new Map();
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };

  function drag(event) {
    const last = pointers.get(event.pointerId);
    if (!last) {
      return;
    }
    const before = apart();
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const angle = fov / Math.max(1, canvas.clientHeight);
    if (pointers.size > 1) {
      zoom(before / Math.max(1, apart()));
    } else {
      look((last.x - event.clientX) * angle, (event.clientY - last.y) * angle);
    }
  }

  function release(event) {
    pointers.delete(event.pointerId);
    canvas.classList.toggle("dragged", pointers.size > 0);
  }

  function listen() {
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      canvas.classList.add("dragged");
    });
    canvas.addEventListener("pointermove", drag);
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0015));
    }, { passive: false });
    window.addEventListener("keydown", (event) => {
      const act = keys[event.key];
      if (act && !event.ctrlKey && !event.metaKey && !event.altKey) {
        event.preventDefault();
        act();
      }
    });
    window.addEventListener("resize", redraw);
    window.addEventListener("hashchange", () => go(Number(location.hash.slice(1)) - 1, false));
    for (const target of document.querySelectorAll("[data-view]:not(body)")) {
      target.addEventListener("click", () => go(Number(target.dataset.view), false));
    }
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      program = prepare();
      const shown = current;
      current = -1;
      go(shown, true);
    });
  }

  program = gl && prepare();
  if (!program) {
    canvas.hidden = true;
    flat.hidden = false;
    say("This browser draws no 3D graphics (WebGL), so the panoramas are shown flat.");
  }
  listen();
  go(Number(location.hash.slice(1)) - 1, false);
  if (current < 0) {
    go(0, false);
  }
})();
