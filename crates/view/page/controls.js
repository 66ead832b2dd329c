// How one moves: around a place (mouse, touch), or freely (keys, and the mouse when flying).

const KEYS = { KeyW: [0, 0, 1], KeyS: [0, 0, -1], KeyD: [1, 0, 0], KeyA: [-1, 0, 0], KeyE: [0, 1, 0], KeyQ: [0, -1, 0] };
const RADIANS_PER_PIXEL = 0.004;
/** Shares of the distance to the target that a second of a held key goes; with Shift, more. */
const [PACE, FAST_PACE] = [0.7, 2.2];

/** Moves a camera. `changed()` is called whenever it stands elsewhere. */
export class Controls {
    constructor(camera, element, changed) {
        this.orbit = new THREE.OrbitControls(camera, element);
        this.orbit.zoomToCursor = true;
        this.orbit.maxPolarAngle = Math.PI * 0.999;
        this.orbit.addEventListener("change", changed);
        Object.assign(this, { camera, element, held: new Set(), fast: false, isFlying: false });
        element.addEventListener("pointermove", (event) => this.look(event));
    }

    get target() {
        return this.orbit.target;
    }

    /** Flying, the mouse turns the head; else the world. */
    fly(isFlying) {
        this.isFlying = isFlying;
        this.orbit.enableRotate = !isFlying;
    }

    look({ buttons, pointerType, movementX, movementY }) {
        if (!this.isFlying || buttons !== 1 || pointerType === "touch") return;
        const way = this.target.clone().sub(this.camera.position);
        const side = way.clone().cross(this.camera.up).normalize();
        const nodded = way.clone().applyAxisAngle(side, -movementY * RADIANS_PER_PIXEL);
        const isUpright = nodded.angleTo(this.camera.up) > 0.05 && nodded.angleTo(this.camera.up) < Math.PI - 0.05;
        const turned = (isUpright ? nodded : way).applyAxisAngle(this.camera.up, -movementX * RADIANS_PER_PIXEL);
        this.target.copy(this.camera.position).add(turned);
        this.orbit.update();
    }

    /** Takes note of a key; whether it is one that moves. */
    key({ code, shiftKey }, isDown) {
        this.fast = shiftKey;
        if (!(code in KEYS)) return false;
        if (isDown) this.held.add(code);
        else this.held.delete(code);
        return true;
    }

    release() {
        this.held.clear();
    }

    get isMoving() {
        return this.held.size > 0;
    }

    /** Goes on as the held keys say. */
    advance(seconds) {
        const forward = this.target.clone().sub(this.camera.position);
        const reach = Math.max(forward.length(), 5) * (this.fast ? FAST_PACE : PACE) * seconds;
        forward.normalize();
        const right = forward.clone().cross(this.camera.up).normalize();
        const step = new THREE.Vector3();
        for (const code of this.held) {
            const [r, u, f] = KEYS[code];
            step.addScaledVector(right, r).addScaledVector(this.camera.up, u).addScaledVector(forward, f);
        }
        step.multiplyScalar(reach);
        this.camera.position.add(step);
        this.target.add(step);
        this.orbit.update();
    }

    /** Stands at a place and looks at another, metres. */
    place(position, target) {
        this.camera.position.fromArray(position);
        this.target.fromArray(target);
        this.orbit.update();
    }
}

/** Places to look from, for a keyframe's grid: a name each, where one stands, and where one looks at. */
export function presetsOf({ min_m, size_m, shape, heading_rad }) {
    const [cos, sin] = [Math.cos(heading_rad ?? 0), Math.sin(heading_rad ?? 0)];
    const span = shape.map((n, axis) => n * size_m[axis]);
    const [x, y] = [0, 1].map((axis) => min_m[axis] + span[axis] / 2);
    const [turned, along] = [Math.abs(sin), Math.abs(cos)];
    const [long, wide] = [span[0] * along + span[1] * turned, span[1] * along + span[0] * turned];
    const reach = Math.max(long, wide);
    const ground = Math.min(Math.max(0, min_m[2]), min_m[2] + span[2]);
    const from = ([x, y]) => (ahead, left, up) => [x + ahead * cos - left * sin, y + ahead * sin + left * cos, up];
    const [centre, ego] = [from([x, y]), from([0, 0])];
    const middle = centre(0, 0, ground);
    return {
        corner: [centre(-1.1 * long, -0.85 * wide, ground + 0.9 * reach), middle],
        top: [centre(-0.001, 0, ground + 1.5 * reach), middle],
        behind: [centre(-0.8 * long, 0, ground + 0.36 * reach), centre(0.05 * long, 0, ground)],
        left: [centre(0, 1.1 * wide, ground + 0.4 * reach), middle],
        right: [centre(0, -1.1 * wide, ground + 0.4 * reach), middle],
        front: [centre(1.2 * long, 0, ground + 0.45 * reach), middle],
        ego: [ego(-9, 0, 5.5), ego(12, 0, 0)],
    };
}
