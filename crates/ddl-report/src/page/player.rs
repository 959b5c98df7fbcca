//! Parts of every page with a player: head, player, scripts.

use super::template::fill;
use crate::{ForecastSnapshot, document::escape, figure::drawing};

const HEAD: &str = include_str!("head.html");
pub(super) const THEME_BUTTON: &str = include_str!("theme_button.html");
const PLAYER: &str = include_str!("player.html");
const STYLE: &str = include_str!("style.css");
/// Scripts of the player, run in this order inside one function.
pub(super) const PLAYER_SCRIPTS: [&str; 12] = [
    include_str!("script/theme.js"),
    include_str!("script/print.js"),
    include_str!("script/moments.js"),
    include_str!("script/metrics.js"),
    include_str!("script/palette.js"),
    include_str!("script/view.js"),
    include_str!("script/scene.js"),
    include_str!("script/phi_chart.js"),
    include_str!("script/hypothesis_list.js"),
    include_str!("script/clock.js"),
    include_str!("script/player.js"),
    include_str!("script/keys.js"),
];

pub(super) fn head(title: &str) -> String {
    let slots = [
        ("title", &*escape(title)),
        ("style", STYLE),
        ("figure-style", drawing::STYLE),
    ];
    fill(HEAD, &slots)
}

pub(super) fn player(moments: &[ForecastSnapshot]) -> String {
    let state = if moments.is_empty() { "empty" } else { "ready" };
    fill(PLAYER, &[("player-state", state)])
}
