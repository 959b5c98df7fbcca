//! A full disk: the error names the file, earlier files stay, and no unfinished file remains.

use super::EVALUATE;
use ddl_tests::folder_contents::half_written;
use ddl_tests::mount::Mount;
use ddl_tests::place::Place;
use ddl_tests::program;

#[test]
fn an_earlier_output_stays() {
    let place = Place::with_model();
    let out = place.at("out");
    std::fs::create_dir(&out).unwrap();
    let Some(disk) = Mount::small(&out, 4 << 10) else {
        return;
    };
    for command in [
        "forecast --model run tracks.csv --last --output out/forecasts.csv",
        &format!("{EVALUATE} --out out/report"),
        "report run --out out/page",
    ] {
        let _ = place.ok(command);
    }
    place.write("out/packed", "an earlier model");
    let files = ["forecasts.csv", "packed"].map(|name| format!("out/{name}"));
    let before = files.clone().map(|name| place.read(&name));
    // Fills the disk completely.
    assert!(std::fs::write(out.join("filler"), vec![0; 8 << 20]).is_err());
    for (command, named) in [
        ("forecast --model run tracks.csv --output", "out/forecasts.csv"),
        ("pack --model run --out", "out/packed"),
        (&format!("{EVALUATE} --protocol single --out"), "out/report"),
    ] {
        let message = place.run(&format!("{command} {named}")).fails();
        assert!(message.contains(named) && message.contains("make room"), "{message}");
    }
    assert_eq!(half_written(&out), Vec::<String>::new());
    assert!(files.map(|name| place.read(&name)) == before);
    disk.resize(64 << 10);
    let _ = place.ok(&format!("{EVALUATE} --protocol single --out out/report"));
}

#[test]
fn a_full_standard_output_is_an_error() {
    let place = Place::with_model();
    let commands = [
        "forecast --model run tracks.csv",
        "info --model run",
        "info",
        "windows --convention simulated --fold corridor",
        "forecast --model run tracks.csv --output /dev/full",
    ];
    for line in commands {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let mut command = program::command(place.path(), line);
        let output = command.stdout(full.unwrap()).output().unwrap();
        let message = program::Finished::new(line.to_owned(), &output).fails();
        let to_file = line.contains("/dev/full");
        let named = if to_file { "/dev/full" } else { "standard output" };
        assert!(message.contains(named) && message.contains("make room"), "{message}");
    }
}
