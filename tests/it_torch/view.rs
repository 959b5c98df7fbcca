//! `ddl view`: forecasts of own tracks as a page.

use ddl_tests::{own_tracks, program};

#[test]
fn a_page_shows_the_moments_of_own_tracks() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let rows = own_tracks::three_people(15);
    std::fs::write(folder.join("lobby.csv"), own_tracks::csv(&rows)).unwrap();

    let told = program::run(folder, "view lobby.csv --moments 5").succeeds();
    assert_eq!(told, "lobby-forecasts.html\n");
    let page = std::fs::read_to_string(folder.join("lobby-forecasts.html")).unwrap();
    // From the second frame on somebody can be forecast.
    assert!(page.contains("5 of 14 moments of lobby.csv"));
    assert!(page.contains("Certificates: 300 of 300 hypotheses"));
    // Nothing is loaded from anywhere: the one address is the name of SVG.
    for after in page.split("http").skip(1) {
        assert!(after.starts_with("://www.w3.org/2000/svg"));
    }

    let data = page.split("id=\"moments-json\">").nth(1).unwrap();
    let data = data.split("</script>").next().unwrap();
    let moments: serde_json::Value = serde_json::from_str(data).unwrap();
    let moments = moments.as_array().unwrap();
    assert_eq!(moments.len(), 5);
    let last = &moments[4];
    assert_eq!(last["frame"], 14 * own_tracks::FRAME_STEP);
    assert_eq!(last["walkers"][0]["truth"], serde_json::json!([]));
    assert_eq!(last["walkers"][0]["paths"].as_array().unwrap().len(), 20);
    // The first of five is the third of fourteen: seen for 3 frames, and what then happened is there.
    assert_eq!(moments[0]["walkers"][0]["made_up"]["padded"], 5);
    assert_eq!(
        moments[0]["walkers"][0]["truth"].as_array().unwrap().len(),
        24
    );
}

#[test]
fn a_page_that_cannot_be_made_is_an_error() {
    let place = tempfile::tempdir().unwrap();
    let rows = own_tracks::three_people(15);
    std::fs::write(place.path().join("lobby.csv"), own_tracks::csv(&rows)).unwrap();
    for (command_line, words) in [
        ("view -", "a file of tracks"),
        ("view nowhere.csv", "cannot read nowhere.csv"),
        (
            "view lobby.csv --output nowhere/page.html",
            "there is no folder nowhere",
        ),
    ] {
        let message = program::run(place.path(), command_line).fails();
        assert!(message.contains(words), "{command_line}: {message}");
    }
    let finished = program::run(place.path(), "view");
    assert_eq!(finished.code, Some(2), "{finished:?}");
    assert!(finished.stderr.contains("<TRACKS>"), "{finished:?}");
}
