//! Parts of every page with a player: head, bar, player, data, scripts.

use crate::figure::drawing;
use crate::snapshot::ForecastSnapshot;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const THEME_BUTTON: &str = include_str!("theme_button.html");
const PLAYER: &str = include_str!("player.html");
const STYLE: &str = include_str!("style.css");
/// A page loads nothing and sends nothing, whatever names it shows.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; \
    base-uri 'none'; form-action 'none'";
/// Scripts of the player, run in this order inside one function.
pub(super) const PLAYER_SCRIPTS: [&str; 17] = [
    include_str!("script/theme.js"),
    include_str!("script/print.js"),
    include_str!("script/moments.js"),
    include_str!("script/metrics.js"),
    include_str!("script/pedestrian_words.js"),
    include_str!("script/futures.js"),
    include_str!("script/palette.js"),
    include_str!("script/view.js"),
    include_str!("script/scene.js"),
    include_str!("script/futures_scene.js"),
    include_str!("script/pointer.js"),
    include_str!("script/phi_chart.js"),
    include_str!("script/hypothesis_list.js"),
    include_str!("script/futures_control.js"),
    include_str!("script/clock.js"),
    include_str!("script/player.js"),
    include_str!("script/keys.js"),
];

/// A whole page with this `body` element.
pub(super) fn document(title: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) (PreEscaped(drawing::STYLE)) }
            }
            (body)
        }
    }
}

/// The bar with links to the parts of the page, given by `id` and name.
pub(super) fn bar(parts: &[(&str, &str)]) -> Markup {
    html! {
        nav.bar aria-label="Parts of this page" {
            div.links {
                @for (id, name) in parts { a href={ "#" (id) } { (name) } }
            }
            (PreEscaped(THEME_BUTTON))
        }
    }
}

pub(super) fn player(moments: &[ForecastSnapshot]) -> Markup {
    let state = if moments.is_empty() { "empty" } else { "ready" };
    html! { section #player class=(state) { (PreEscaped(PLAYER)) } }
}

/// Data for the scripts, given by `id` and JSON, and the scripts, run in one function.
pub(super) fn scripts(data: &[(&str, &str)], scripts: &[&str]) -> Markup {
    html! {
        @for (id, json) in data {
            script type="application/json" id=(id) { (PreEscaped(json_in_script(json))) }
            "\n"
        }
        script {
            (PreEscaped("\n(() => {\n\"use strict\";\n"))
            (PreEscaped(scripts.join("\n")))
            (PreEscaped("\n})();\n"))
        }
    }
}

/// JSON that cannot end its `script` element.
fn json_in_script(json: &str) -> String {
    let mut escaped = json.replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029");
    // `</script`, `<!--` and `<script` begin with these.
    for start in ["/", "!", "s", "S"] {
        escaped = escaped.replace(&format!("<{start}"), &format!("\\u003c{start}"));
    }
    escaped
}
