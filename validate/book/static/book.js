// What the keyboard needs: whatever scrolls sideways can be reached by it.
(() => {
"use strict";
const reach = () => document.querySelectorAll("pre, div.math, .katex-display, .table-wrapper, .cell_output > *").forEach(part => {
  if (part.scrollWidth > part.clientWidth + 1) part.tabIndex = 0;
});
addEventListener("load", reach);
addEventListener("resize", reach);
})();
