// What keys do.

import { presetsOf } from "./controls.js";

const PRESET_KEYS = ["Digit1", "Digit2", "Digit3", "Digit4", "Digit5", "Digit6", "Digit7"];

/** Does what a pressed key says, unless it is meant for the control that has the focus. */
export function press(viewer, event) {
    const { code, target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || /SELECT|SUMMARY/.test(target.tagName)) return;
    const isForButton = code === "Space" && /BUTTON|INPUT/.test(target.tagName);
    const does = target.id === "slice-at" || isForButton ? undefined : actions(viewer)[code];
    if (does) does();
    else if (!viewer.controls.key(event, true)) return;
    event.preventDefault();
    viewer.wake();
}

function actions(viewer) {
    const presets = Object.keys(presetsOf(viewer.scene.keyframes[0]));
    const looks = PRESET_KEYS.map((key, at) => [key, () => viewer.lookFrom(presets[at])]);
    return {
        ArrowLeft: () => viewer.step(-1),
        ArrowRight: () => viewer.step(1),
        Home: () => viewer.step(-Infinity),
        End: () => viewer.step(Infinity),
        Space: () => viewer.play(!viewer.isPlaying),
        KeyR: () => viewer.lookFrom("corner"),
        Escape: () => viewer.pick(null),
        ...Object.fromEntries(looks),
    };
}
