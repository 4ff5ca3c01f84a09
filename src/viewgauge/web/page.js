// What viser's page lacks for keyboards and screen readers: names of sliders, number fields and icon buttons, and
// folders that can be reached and opened by keys. Its elements come and go: they are named whenever the page changes.
(function () {
  if (window.viewgaugeNames) return; // once for each page, also after the connection was lost
  window.viewgaugeNames = true;
  document.documentElement.lang = "en";
  document.title = "viewgauge workbench";

  function name(element, text) {
    if (element && text && !element.getAttribute("aria-label")) element.setAttribute("aria-label", text);
  }
  function nameSliders() {
    for (const root of document.querySelectorAll(".mantine-Slider-root[id]")) {
      const label = document.querySelector(`label[for="${CSS.escape(root.id)}"]`)?.textContent;
      name(root.querySelector("[role=slider]"), label);
      name(root.parentElement.querySelector("input.mantine-NumberInput-input"), label);
    }
  }
  function nameButtons() {
    for (const button of document.querySelectorAll("button, [role=button]")) {
      if (button.textContent.trim() || button.getAttribute("aria-label")) continue;
      name(button, button.classList.contains("mantine-Notification-closeButton") ? "Close" : "Connection and display");
    }
  }
  function openFoldersByKeys() {
    for (const head of document.querySelectorAll(".mantine-Paper-root > .mantine-Paper-root:first-child")) {
      if (!head.querySelector(":scope > svg")) continue;
      head.setAttribute("aria-expanded", String(Boolean(head.querySelector(".tabler-icon-chevron-up"))));
      if (head.tabIndex === 0) continue;
      head.tabIndex = 0;
      head.setAttribute("role", "button");
      head.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        head.click();
      });
    }
  }
  let waiting = false;
  function again() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      nameSliders();
      openFoldersByKeys();
      nameButtons();
    });
  }
  new MutationObserver(again).observe(document.body, { childList: true, subtree: true });
  again();
})();
