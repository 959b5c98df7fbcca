// The keys of the player. They work while an element of the player has the focus; `?` works everywhere.

const SWITCHES = { t: "truth", h: "hypotheses", g: "goals", a: "region", o: "others", e: "everything", z: "whole" };

function bindKeys(player) {
  const dialog = document.getElementById("keys");
  const actions = {
    " ": () => player.clock.toggle(),
    ArrowLeft: () => player.clock.step(-1),
    ArrowRight: () => player.clock.step(1),
    ArrowUp: () => player.nextPedestrian(-1),
    ArrowDown: () => player.nextPedestrian(1),
    Home: () => player.clock.set(0),
    End: () => player.clock.set(FRAMES - 1),
    p: () => player.nextMoment(-1),
    n: () => player.nextMoment(1),
    d: () => player.nextFuture(-1),
    f: () => player.nextFuture(1),
    r: () => player.nextRecording(),
    w: () => player.sortByWeight(),
  };
  for (const [key, name] of Object.entries(SWITCHES)) actions[key] = () => player.toggle(name);

  player.stage.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Selects, the slider and scrolling boxes use the arrow keys themselves; buttons and check boxes use the space key.
    const on = event.target;
    if (on.matches("select")) return;
    if (on.matches("input[type=range], .table") && /^(Arrow|Home|End)/.test(event.key)) return;
    if (event.key === " " && on.matches("button, input[type=checkbox]")) return;
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
  // After the list of keys, or a link to the player, the keys must work in the player.
  const toPlayer = () => document.getElementById("play").focus({ preventScroll: true });
  dialog.addEventListener("close", toPlayer);
  document.querySelector('a[href="#player"]')?.addEventListener("click", () => setTimeout(toPlayer));
  document.addEventListener("keydown", (event) => {
    if (event.key !== "?" || event.target.matches("select")) return;
    event.preventDefault();
    if (dialog.open) dialog.close();
    else dialog.showModal();
  });
}

{
  const moments = embedded("moments-json");
  if (moments.length > 0) {
    const player = makePlayer(moments);
    bindKeys(player);
    window.ddlPlayer = { measure: player.measure };
  }
}
