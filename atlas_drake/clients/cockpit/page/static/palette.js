// Colors of quantities, as in atlas_drake/palette.py.

export const COM = "#1a9e52", DCM = "#c71f8c", COP = "#d91f1a";
export const FEET = ["#1a6bd9", "#e66b14"]; // Left, right.
export const BEHAVIOR = "#5285d1", SHARED = "#a84cad", USER = "#f5941f";
export const POLICY = "#1a998c"; // Of joints that a learned policy has.
