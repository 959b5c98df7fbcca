// Light, dark, or as in the system. The choice is stored if the browser allows it for files.

const THEMES = ["auto", "light", "dark"];
const THEME_WORDS = { auto: "as in the system", light: "light", dark: "dark" };
const themeListeners = [];

function onThemeChange(listener) {
  themeListeners.push(listener);
}

function applyTheme(theme) {
  const root = document.documentElement;
  if (theme === "auto") delete root.dataset.theme;
  else root.dataset.theme = theme;
  const button = document.getElementById("theme");
  button.querySelector("span").textContent = theme[0].toUpperCase() + theme.slice(1);
  button.setAttribute("aria-label", `Colours: ${THEME_WORDS[theme]}; change`);
  themeListeners.forEach((listener) => listener());
}

{
  let theme = "auto";
  try {
    theme = localStorage.getItem("ddl-theme") ?? "auto";
  } catch {
    // Some browsers store nothing for files: the system's colours are used.
  }
  if (!THEMES.includes(theme)) theme = "auto";
  applyTheme(theme);
  document.getElementById("theme").addEventListener("click", () => {
    theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
    applyTheme(theme);
    try {
      localStorage.setItem("ddl-theme", theme);
    } catch {
      // The choice then lasts until the page is closed.
    }
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => themeListeners.forEach((listener) => listener()));
}
