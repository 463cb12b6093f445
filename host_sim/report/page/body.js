"use strict";
// The body and its path in 3D, by three.js: before and after, at the cursor's time.
const Body = (() => {
  /** q and p of a motion at the record nearest before t. */
  function sample(motion, t) {
    const i = Math.max(0, Charts.lower(motion.t, t + 1e-9) - 1);
    const q = motion.q.map((c) => c[i]), p = motion.p.map((c) => c[i]);
    return { q: q.length === 4 && !q.some(Number.isNaN) ? q : null,
             p: p.length === 3 && !p.some(Number.isNaN) ? p : null };
  }

  function board(opacity) {
    const group = new THREE.Group();
    const material = (color) => new THREE.MeshLambertMaterial({
      color, transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
    group.add(new THREE.Mesh(new THREE.BoxGeometry(1.5, 1, 0.18), material(0x3c6e9f)));
    [[0xd9534f, [1, 0, 0]], [0x2fa57c, [0, 1, 0]], [0x2f7ed8, [0, 0, 1]]].forEach(([color, d]) => {
      const arrow = new THREE.ArrowHelper(new THREE.Vector3(...d), new THREE.Vector3(), 1.25, color, 0.25, 0.14);
      arrow.line.material.transparent = arrow.cone.material.transparent = opacity < 1;
      arrow.line.material.opacity = arrow.cone.material.opacity = opacity;
      group.add(arrow);
    });
    return group;
  }

  /** Where the path goes: its middle and its size in m. */
  function extent(motion) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    motion.p.forEach((c, k) => c.forEach((v) => {
      if (v < low[k]) low[k] = v;
      if (v > high[k]) high[k] = v;
    }));
    if (!(low[0] <= high[0])) return { middle: [0, 0, 0], size: 0 };
    return { middle: low.map((v, k) => (v + high[k]) / 2),
             size: Math.max(...high.map((v, k) => v - low[k])) };
  }

  function path(motion, middle, unit, color) {
    const n = motion.t.length, every = Math.max(1, Math.floor(n / 8000)), points = [];
    for (let i = 0; i < n; i += every) {
      const p = motion.p.map((c) => c[i]);
      if (!p.some(Number.isNaN)) points.push(new THREE.Vector3(...p.map((v, k) => (v - middle[k]) * unit)));
    }
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color }));
  }

  class View {
    /** motions: {before, after}; each {t, q[4], p[3] or p[0]}. */
    constructor(box, before, after) {
      this.box = box;
      this.before = before;
      this.after = after;
      this.showBefore = true;
      const { middle, size } = extent(after);
      this.middle = middle;
      this.unit = size > 0 ? 8 / size : 1;  // the path fills the view; the body is of fixed size
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
      box.append(this.renderer.domElement);
      this.scene = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(40, 1, 0.1, 500);
      this.camera.up.set(0, 0, 1);
      const far = size > 0 ? 13 : 4.6;
      this.camera.position.set(-0.62 * far, -0.62 * far, 0.48 * far);
      this.scene.add(new THREE.AmbientLight(0xffffff, 0.65));
      const light = new THREE.DirectionalLight(0xffffff, 0.6);
      light.position.set(-3, -6, 9);
      this.scene.add(light);
      const grid = new THREE.GridHelper(size > 0 ? 12 : 4, size > 0 ? 12 : 8, 0x8a8f98, 0x8a8f98);
      grid.rotateX(Math.PI / 2);  // z is up
      grid.position.z = size > 0 ? -4.2 : -1.3;
      grid.material.transparent = true;
      grid.material.opacity = 0.35;
      this.scene.add(grid);
      this.ghost = board(0.3);
      this.solid = board(1);
      this.scene.add(this.ghost, this.solid);
      if (size > 0) {
        this.scene.add(path(before, middle, this.unit, 0xa9b1bc));
        this.scene.add(path(after, middle, this.unit, 0x2f7ed8));
      }
      this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
      this.controls.addEventListener("change", () => this.render());
      new ResizeObserver(() => this.resize()).observe(box);
      this.resize();
    }
    resize() {
      const w = this.box.clientWidth, h = this.box.clientHeight;
      this.renderer.setSize(w, h);
      this.camera.aspect = w / Math.max(1, h);
      this.camera.updateProjectionMatrix();
      this.render();
    }
    place(group, motion, t) {
      const { q, p } = sample(motion, t);
      if (q) group.quaternion.set(q[1], q[2], q[3], q[0]);
      if (p) group.position.set(...p.map((v, k) => (v - this.middle[k]) * this.unit));
      return q !== null || p !== null;
    }
    show(t) {
      this.solid.visible = this.place(this.solid, this.after, t);
      this.ghost.visible = this.place(this.ghost, this.before, t) && this.showBefore;
      this.render();
    }
    render() { this.renderer.render(this.scene, this.camera); }
  }
  return { View };
})();
