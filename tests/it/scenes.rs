//! Joint futures, risk and occupancy of the program.

use ddl_tests::own_tracks::{self, Row};
use ddl_tests::place::{Place, json_lines};
use serde_json::Value;

/// Two side by side, one who comes towards them, and one far away; for 10 steps.
fn rows() -> Vec<Row> {
    let at = |t: i64| {
        let x = 0.5 * t as f64;
        [(t, 1, x, 0.0), (t, 2, x, 0.7), (t, 3, 9.0 - x, 0.2), (t, 4, 40.0, 40.0 + x)]
    };
    (0..10).flat_map(at).collect()
}

const PLANS: &str = "plan,t,x,y,radius\nthrough,0,9,1,0.3\nthrough,4.8,3,-1,0.3\naway,0,-20,-20,0.3\n";

fn place() -> Place {
    let place = Place::empty();
    place.write_tracks("tracks.csv", &rows());
    place.write("plans.csv", PLANS);
    place.write("robot.csv", "t,x,y\n0,7,0.3\n4.8,7,0.3\n");
    place
}

#[test]
fn futures_are_of_the_scene_and_the_same_in_a_stream() {
    let place = place();
    let options = "--fps 2.5 --joint --threads 1 --format jsonl";
    let of_file = place.ok(&format!("forecast tracks.csv {options}"));
    let streamed = place.run_on(&own_tracks::csv(&rows()), &format!("forecast - {options}"));
    assert!(streamed.succeeds() == of_file, "a stream has other futures");
    let last = json_lines::<Value>(&of_file).pop().unwrap();
    assert_eq!(last["groups"], serde_json::json!([[1, 2]]));
    assert_eq!(last["parts"], serde_json::json!([[1, 2, 3], [4]]));
    let futures = last["futures"].as_array().unwrap();
    let weights = futures.iter().map(|future| future["weight"].as_f64().unwrap());
    assert!(futures.len() == 20 && (weights.sum::<f64>() - 1.0).abs() < 1e-9);
    let end = |future: &Value, i: usize| -> Vec<f64> {
        let end = future["paths"][i]["positions"].as_array().unwrap().last().unwrap();
        serde_json::from_value(end.clone()).unwrap()
    };
    let [a, b] = [0, 1].map(|i| end(&futures[0], i));
    assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1.5, "the likeliest future parts a group: {a:?} {b:?}");
    let csv = place.ok("forecast tracks.csv --fps 2.5 --joint --last --certificate --region 0.9");
    assert!(csv.starts_with("observed_until,pedestrian,future,weight,") && !csv.contains(",false,"));
    // One pedestrian alone has its own hypotheses.
    place.write_tracks("one.csv", &rows().into_iter().filter(|row| row.1 == 4).collect::<Vec<_>>());
    let one = |joint: &str| place.ok(&format!("forecast one.csv --fps 2.5 --last{joint}"));
    assert_eq!(one(" --joint").replace(",future,", ",hypothesis,"), one(""));
}

#[test]
fn the_others_make_way_for_a_plan() {
    let place = place();
    let ends = |options: &str| -> f64 {
        let lines = place.ok(&format!("forecast tracks.csv --fps 2.5 --joint --last --format jsonl {options}"));
        let line: Value = json_lines(&lines).pop().unwrap();
        let futures = line["futures"].as_array().unwrap();
        let through = |future: &&Value| {
            let path = future["paths"][0]["positions"].as_array().unwrap().iter();
            path.into_iter().any(|at| (at[0].as_f64().unwrap() - 7.0).hypot(at[1].as_f64().unwrap() - 0.3) < 0.3)
        };
        futures.iter().filter(through).map(|future| future["weight"].as_f64().unwrap()).sum()
    };
    let (without, given) = (ends(""), ends("--plan robot.csv"));
    assert!(given < 0.5 * without, "{given} of {without} walk through the robot");
    let ego = place.ok("forecast tracks.csv --fps 2.5 --joint --last --plan robot.csv --ego 4");
    assert_eq!(ego.lines().filter(|line| line.starts_with("9,4,") && line.contains(",7.0,0.3,")).count(), 240);
}

#[test]
fn risk_is_high_where_people_walk() {
    let place = place();
    let risk = |options: &str| -> Vec<Value> {
        json_lines(&place.ok(&format!("risk tracks.csv --fps 2.5 --last --plan plans.csv --format jsonl {options}")))
    };
    let [through, away] = risk("").try_into().unwrap();
    let of = |line: &Value| line["risk"].as_f64().unwrap();
    assert_eq!((&through["plan"], &away["plan"]), (&"through".into(), &"away".into()));
    assert!(of(&away) < 1e-6, "{away}");
    assert!(of(&risk("--unseen")[0]) > of(&through) && of(&risk("--within 2")[0]) > of(&through));
    let without = &risk("--ego 3")[0]["pedestrians"];
    assert_eq!(without.as_array().unwrap().len(), 3);
    assert!(risk("--nearest")[1]["nearest"].as_f64().unwrap() > 20.0);
    let csv = place.ok("risk tracks.csv --fps 2.5 --last --plan robot.csv");
    assert!(csv.starts_with("observed_until,plan,within,risk,pedestrian,pedestrian_risk,until_0.4,"));
    let streamed = place.run_on(&own_tracks::csv(&rows()), "risk - --fps 2.5 --plan robot.csv");
    assert_eq!(streamed.succeeds().lines().last(), csv.lines().last());
}

/// Monte Carlo on what `forecast` prints of people who cannot meet: each follows one of its hypotheses, and deviates
/// from it for the whole future by its scale times a draw of Student's t with 3 degrees of freedom.
#[test]
fn risk_is_that_of_the_printed_hypotheses() {
    const DRAWS: usize = 3000;
    let place = place();
    let starts = [[4.5, 0.0], [4.5, 40.0], [40.0, 4.5]];
    let rows: Vec<Row> = (0..10)
        .flat_map(|t| {
            let back = 0.5 * (9 - t) as f64;
            [(t, 1, 4.5 - back, 0.0), (t, 2, 4.5 - back, 40.0), (t, 3, 40.0, 4.5 + 0.1 * back)]
        })
        .collect();
    place.write_tracks("apart.csv", &rows);
    place.write("plans.csv", "t,x,y,radius\n0,5.5,-20,0.3\n4.8,9.5,50,0.3\n");
    let ask = |command: &str| json_lines::<Value>(&place.ok(command));
    let numbers = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let mut random = fastrand::Rng::with_seed(5);
    let mut normal = || (-2.0 * (1.0 - random.f64()).ln()).sqrt() * (std::f64::consts::TAU * random.f64()).cos();
    let mut deviation = || {
        let square: f64 = (0..3).map(|_| normal().powi(2)).sum();
        [0, 1].map(|_| normal() / (square / 3.0).sqrt())
    };
    let (mut nobody, mut pedestrians) = ([1.0; 12], [0.0; 3]);
    for (i, of_one) in ask("forecast apart.csv --fps 2.5 --last --format jsonl").iter().enumerate() {
        let scales = [&[0.0], &numbers(&of_one["spread"])[..]].concat();
        let mut close = [0.0; 12];
        for hypothesis in of_one["hypotheses"].as_array().unwrap() {
            let weight = hypothesis["weight"].as_f64().unwrap();
            let mut path = vec![starts[i]];
            path.extend(hypothesis["positions"].as_array().unwrap().iter().map(|at| [numbers(at)[0], numbers(at)[1]]));
            for z in (0..DRAWS).map(|_| deviation()) {
                let at = |t: usize, axis: usize| path[t][axis] + scales[t] * z[axis];
                // From the edge of the plan, at every part of a step.
                let is_close = |part: &usize| {
                    let (step, share) = ((part - 1) / 64, ((part - 1) % 64 + 1) as f64 / 64.0);
                    let along = *part as f64 / 768.0;
                    let plan = [5.5 + 4.0 * along, -20.0 + 70.0 * along];
                    let [x, y] =
                        [0, 1].map(|axis| at(step, axis) * (1.0 - share) + at(step + 1, axis) * share - plan[axis]);
                    x.hypot(y) - 0.3 <= 0.5
                };
                let first = (1..=768).find(is_close).map_or(12, |part| (part - 1) / 64);
                for close in &mut close[first..] {
                    *close += weight / DRAWS as f64;
                }
            }
        }
        pedestrians[i] = close[11];
        nobody = std::array::from_fn(|step| nobody[step] * (1.0 - close[step]));
    }
    let risk = ask("risk apart.csv --fps 2.5 --last --plan plans.csv --unseen --format jsonl").swap_remove(0);
    let of_each = risk["pedestrians"].as_array().unwrap().iter().map(|one| one["risk"].as_f64().unwrap());
    let found = numbers(&risk["until"]).into_iter().chain(of_each);
    assert!(pedestrians[0] > 0.1 && pedestrians[1] > 0.1, "{pedestrians:?}");
    for (found, expected) in found.zip(nobody.map(|nobody| 1.0 - nobody).into_iter().chain(pedestrians)) {
        assert!((found - expected).abs() < 0.01, "{risk} {nobody:?} {pedestrians:?}");
    }
}

/// Five people a kilometre away, or other names, change no digit of a risk or a grid; of a stream neither.
#[test]
fn who_is_far_and_who_has_which_name_does_not_matter() {
    let place = place();
    let crowd = |names: [i64; 4], others: &[Row]| [&renamed(&rows(), names), others].concat();
    let far: Vec<Row> = (0..10)
        .flat_map(|t| (0..5).map(move |i| (t, 20 + i, 1000.0 + 0.3 * (t * i) as f64, 990.0 + 0.4 * t as f64)))
        .collect();
    let answers = |rows: &[Row]| {
        let mut rows = rows.to_vec();
        rows.sort_by_key(|row| row.0);
        place.write_tracks("crowd.csv", &rows);
        let risk = place.ok("risk crowd.csv --fps 2.5 --last --plan plans.csv --nearest");
        // Without the name of the pedestrian most at risk.
        let numbers = risk.lines().map(|line| line.split(',').enumerate().filter(|(column, _)| *column != 5));
        let numbers: Vec<Vec<String>> = numbers.map(|line| line.map(|(_, field)| field.to_owned()).collect()).collect();
        let grid = place.ok("occupancy crowd.csv --fps 2.5 --last --every 2.4 --cell 0.25 --area=-2,-3,14,3");
        let streamed = place.run_on(&own_tracks::csv(&rows), "risk - --fps 2.5 --plan plans.csv --nearest");
        let streamed = streamed.succeeds().lines().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(risk.lines().skip(1).collect::<Vec<_>>(), streamed[streamed.len() - 2..]);
        (numbers, grid)
    };
    let alone = answers(&crowd([1, 2, 3, 4], &[]));
    assert_eq!(alone, answers(&crowd([1, 2, 3, 4], &far)));
    assert_eq!(alone, answers(&crowd([30, 7, 28, 3], &far)));
}

fn renamed(rows: &[Row], names: [i64; 4]) -> Vec<Row> {
    rows.iter().map(|&(t, name, x, y)| (t, names[name as usize - 1], x, y)).collect()
}

/// The risk of each plan of a file, and what is told.
fn risks(place: &Place, plan: &str) -> (Vec<String>, String) {
    place.write("doubtful.csv", plan);
    let told = place.run("risk tracks.csv --fps 2.5 --last --plan doubtful.csv");
    assert_eq!(told.code, Some(0), "{told:?}");
    (told.stdout.lines().skip(1).map(|line| line.split(',').nth(3).unwrap().to_owned()).collect(), told.stderr)
}

#[test]
fn plans_are_doubted_and_the_risk_still_comes() {
    let place = place();
    let good = "t,x,y,radius\n0,9,1,0.3\n4.8,3,-1,0.3\n";
    let (of_good, told) = risks(&place, good);
    assert!(!told.contains("plan"), "{told}");
    let (late, told) = risks(&place, &format!("{good}60,3,-1,5\n"));
    assert!(late == of_good && told.contains("the plan has the radius 5 m in row 3"), "{told}");
    for (plan, words) in [
        ("t,x,y\n0,900,100\n4.8,300,-100\n", "are its positions in centimetres?"),
        ("t,x,y\n0,9,1\n400,8.5,1\n800,8,1\n", "are its times milliseconds?"),
        ("t,x,y\n0,409,1\n4.8,405,1\n", "or more from everybody;"),
        ("t,x,y\n0,45,40\n", ""),
    ] {
        let (risk, told) = risks(&place, plan);
        let lines = told.lines().filter(|line| line.starts_with("warning: the plan ") && line.contains(words)).count();
        assert_eq!((risk.len(), lines), (1, usize::from(!words.is_empty())), "{plan}: {told}");
    }
    // The pedestrian who follows the plan is told of too, by risk and forecast alike.
    for command in ["risk tracks.csv", "forecast tracks.csv --joint"] {
        let told = |ego: &str| place.run(&format!("{command} --fps 2.5 --last --plan robot.csv --ego {ego}")).stderr;
        assert!(told("3").contains("the plan starts 2.5 m from the pedestrian who follows it"), "{}", told("3"));
        assert!(told("77").contains("pedestrian 77, who is said to follow the plan, is not there"));
    }
}

/// A false track of two rows in a stream of two people.
#[test]
fn somebody_far_away_costs_no_grid() {
    let place = Place::empty();
    let far = [(4, 9, 2000.0, 2000.0), (5, 9, 2000.0, 2000.4)];
    let people: Vec<Row> = rows().into_iter().filter(|row| row.1 < 3).collect();
    let with_far: Vec<Row> = people.iter().chain(&far).copied().collect();
    let grids = |rows: &[Row]| {
        let mut rows = rows.to_vec();
        rows.sort_by_key(|row| (row.0, row.1));
        place.run_on(&own_tracks::csv(&rows), "occupancy - --fps 2.5 --every 4.8 --cell 0.2")
    };
    let (told, alone) = (grids(&with_far), grids(&people));
    for finished in [&told, &alone] {
        let cells =
            json_lines::<Value>(&finished.stdout).into_iter().map(|grid| grid["data"].as_array().unwrap().len());
        let cells: Vec<usize> = cells.collect();
        assert!(cells.len() == 20 && cells.iter().all(|cells| *cells < 6000), "{cells:?}");
    }
    assert_eq!(told.stderr.matches("the grids leave out 1 of 3 pedestrians, first 9: they are").count(), 1, "{told:?}");
    assert!(!alone.stderr.contains("leave out"));
    assert_eq!(told.code, Some(0));
}

#[test]
fn occupancy_has_the_formats_of_maps() {
    let place = place();
    let occupancy = "occupancy tracks.csv --fps 2.5 --last --cell 0.25 --every 1.2";
    let grids: Vec<Value> = json_lines(&place.ok(&format!("{occupancy} --area=-2,-3,14,3")));
    assert_eq!(grids.len(), 5);
    assert_eq!((&grids[0]["info"]["width"], &grids[0]["info"]["height"]), (&64.into(), &24.into()));
    assert_eq!(grids[0]["data"].as_array().unwrap().len(), 64 * 24);
    place.ok(&format!("{occupancy} --folder grids"));
    assert!(
        place.read("grids/9.npy").starts_with(b"\x93NUMPY") && place.text("grids/9.yaml").contains("times: [0.0, 1.2")
    );
    place.ok(&format!("{occupancy} --folder grids --format pgm"));
    assert!(
        place.read("grids/9_4.80s.pgm").starts_with(b"P5\n")
            && place.text("grids/9_4.80s.yaml").contains("9_4.80s.pgm")
    );
}
