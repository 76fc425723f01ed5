// On paper nothing can be unfolded.
(function () {
  const folded = () => document.querySelectorAll("details");
  const open = new Set();
  addEventListener("beforeprint", () => { for (const each of folded()) { if (each.open) open.add(each); each.open = true; } });
  addEventListener("afterprint", () => { for (const each of folded()) each.open = open.has(each); open.clear(); });
})();
