// What the keyboard needs: all that scrolls sideways can be reached by it.
(() => {
"use strict";
const reach = () => document.querySelectorAll("pre, div.math, .katex-display, .table-wrapper, .cell_output > *").forEach(part => {
  if (part.scrollWidth > part.clientWidth + 1) part.tabIndex = 0;
});
addEventListener("load", reach);
addEventListener("resize", reach);

// A browser runs no lesson from a file: only a web server may give it the program.
// A narrow screen gets the notebook alone; JupyterLab's panels would cover it.
addEventListener("DOMContentLoaded", () => document.querySelectorAll("a[data-live]").forEach(button => {
  if (matchMedia("(max-width: 700px)").matches) button.href = button.href.replace("/lab/index.html", "/notebooks/index.html");
  if (location.protocol !== "file:") return;
  button.outerHTML = "<span>This lesson runs in your browser when the book comes from a web server, and not from a file.</span>";
}));
})();
