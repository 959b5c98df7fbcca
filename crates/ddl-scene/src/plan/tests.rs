use super::*;
use proptest::prelude::*;

fn plan(rows: &[[f64; 4]]) -> Result<Plan, PlanError> {
    Plan::new(rows.iter().map(|&[time, x, y, radius]| PlanPoint { time, position: [x, y], radius }).collect())
}

#[test]
fn between_rows_the_way_is_a_line_and_the_radius_holds() {
    let plan = plan(&[[1.0, 2.0, -3.0, 0.2], [3.0, 6.0, 5.0, 1.0], [4.0, 6.0, 5.5, 0.0]]).unwrap();
    for (time, [x, y, radius]) in [
        (-5.0, [2.0, -3.0, 0.2]),
        (1.0, [2.0, -3.0, 0.2]),
        (1.5, [3.0, -1.0, 0.2]),
        (3.0, [6.0, 5.0, 1.0]),
        (3.6, [6.0, 5.3, 1.0]),
        (4.0, [6.0, 5.5, 0.0]),
        (60.0, [6.0, 5.5, 0.0]),
    ] {
        let found = plan.at(time);
        let off = [found.time - time, found.position[0] - x, found.position[1] - y, found.radius - radius];
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{found:?}");
    }
}

#[test]
fn rows_that_make_no_plan_are_refused() {
    let good = [0.0, 1.0, 2.0, 0.3];
    let edges = [[-9.0, 1e7, -1e7, 0.0], [0.0, 1.0, 1.0, 0.0]];
    assert!(plan(&edges).is_ok() && plan(&edges[..1]).is_err() && plan(&[]).is_err());
    assert!(plan(&[[4.8, 1.0, 1.0, 0.0]]).is_ok() && plan(&[[4.9, 1.0, 1.0, 0.0]]).is_err());
    assert!(plan(&[good, good]).is_err() && plan(&[[1.0, 1.0, 2.0, 0.3], good]).is_err());
    let wrong = [[0.0, f64::NAN], [1.0, f64::INFINITY], [1.0, 1.1e7], [2.0, -1.1e7], [3.0, 1.1e7], [3.0, -0.1]];
    for (column, value) in wrong.map(|[column, value]| (column as usize, value)) {
        let mut wrong = [1.0, 1.0, 2.0, 0.3];
        wrong[column] = value;
        let refused = plan(&[good, wrong]).unwrap_err();
        let start = format!("row 2 of the plan: {} is {value}", ["time", "x", "y", "radius"][column]);
        assert!(refused.to_string().starts_with(&start), "{refused}");
    }
}

proptest! {
    /// A plan of a robot among people is not doubted; the same plan in other units, axes or at another place is.
    /// It has 9.6 m at most, so that none ends near the diagonal, where exchanged axes cannot be told.
    #[test]
    fn plans_are_doubted_as_tracks_are(
        from in [1.0..9.0f64, 31.0..39.0f64], away in 0.0..2.0f64, turn in 0.0..6.2f64, speed in 0.5..2.0f64,
    ) {
        let [dx, dy] = [speed * turn.cos(), speed * turn.sin()];
        let row = |t: f64| [t, from[0] + t * dx, from[1] + t * dy, 0.3];
        let rows = [row(0.0), row(0.4), row(4.8)];
        let people = [[900.0, -900.0], [from[0] + away, from[1]], [1e4, 1e4]];
        let kinds = |scale: [f64; 4], exchanged: bool, ego: Option<usize>| -> Vec<&str> {
            let rows = rows.map(|row| {
                let [t, x, y, r] = [0, 1, 2, 3].map(|column| row[column] * scale[column]);
                if exchanged { [t, y, x, r] } else { [t, x, y, r] }
            });
            plan(&rows).unwrap().doubts(&people, ego).iter().map(PlanDoubt::kind).collect()
        };
        prop_assert!(kinds([1.0; 4], false, None).is_empty() && kinds([1.0; 4], false, Some(1)).len() < 2);
        let centimetres = kinds([1.0, 100.0, 100.0, 1.0], false, None);
        prop_assert!(centimetres.contains(&"fast plan") && centimetres.contains(&"far plan"));
        prop_assert_eq!(kinds([1000.0, 1.0, 1.0, 1.0], false, None), ["slow plan"]);
        prop_assert!(kinds([1.0; 4], false, Some(0)).contains(&"far ego"));
        let doubts = plan(&rows.map(|[t, x, y, r]| [t, y, x, r])).unwrap().doubts(&people, None);
        prop_assert!(matches!(doubts[..], [PlanDoubt::Far { is_exchanged: true, .. }]), "{:?}", doubts);
        let late = [&rows[..], &[[60.0, rows[2][1], rows[2][2], 5.0]]].concat();
        let doubt = PlanDoubt::LateRadius { row: 4, time: 60.0, radius: 5.0 };
        prop_assert_eq!(plan(&late).unwrap().doubts(&people, None), [doubt]);
        prop_assert!(plan(&rows).unwrap().doubts(&[], None).is_empty());
    }
}
