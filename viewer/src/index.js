// What the bundle `kanegenViewer` offers to pages.

export { page } from "./page.js";
export { addStyle, make, icon, toggle, withUnit } from "./elements.js";
export { Stage, CAMERAS } from "./stage.js";
export { Motion } from "./motion.js";
export { Player } from "./player.js";
export { Plot } from "./plot.js";
export { poses, pointOf, POSE } from "./kinematics.js";
