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

/** Places to look from, for a grid: a name each, where one stands, and where one looks at. */
export function presetsOf({ min_m, size_m, shape }) {
    const span = shape.map((n, axis) => n * size_m[axis]);
    const [x, y] = [0, 1].map((axis) => min_m[axis] + span[axis] / 2);
    const [long, wide] = [span[0], span[1]];
    const reach = Math.max(long, wide);
    const ground = Math.min(Math.max(0, min_m[2]), min_m[2] + span[2]);
    const centre = [x, y, ground];
    return {
        corner: [[x - 0.95 * long, y - 0.72 * wide, ground + 0.8 * reach], centre],
        top: [[x - 0.001, y, ground + 1.5 * reach], centre],
        behind: [[x - 0.8 * long, y, ground + 0.36 * reach], [x + 0.05 * long, y, ground]],
        left: [[x, y + 1.1 * wide, ground + 0.4 * reach], centre],
        right: [[x, y - 1.1 * wide, ground + 0.4 * reach], centre],
        front: [[x + 1.2 * long, y, ground + 0.45 * reach], centre],
        ego: [[-9, 0, 5.5], [12, 0, 0]],
    };
}
