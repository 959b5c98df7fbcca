//! Homographies: pixels to metres.

use ddl_data::{Format, Homography, parse_recording};
use proptest::prelude::*;

/// The matrix of a camera above a street, in the notation of `H.txt`.
const STREET: &str = "\
   2.8128700e-02   2.0091900e-03  -4.6693600e+00
   8.0625700e-04   2.5195500e-02  -5.0608800e+00
   3.4555400e-04   9.2512200e-05   4.6255300e-01
";

/// The expected places were computed in Python, row by row.
#[test]
fn a_camera_above_a_street() {
    let ground: Homography = STREET.parse().unwrap();
    for (pixel, place) in [
        ([0.0, 0.0], [-10.094_756_709, -10.941_189_442]),
        ([320.0, 240.0], [8.086_277_626, 2.089_657_058]),
        ([100.5, 400.25], [-1.943_158_346, 9.553_733_768]),
    ] {
        let [x, y] = ground.apply(pixel).unwrap();
        assert!((x - place[0]).hypot(y - place[1]) < 1e-8, "{pixel:?}: {x} {y}");
    }
}

#[test]
fn invalid_matrices_are_refused() {
    let cases = "
 => a homography has three rows of three numbers, found 0
1 0 0/0 1 0 => a homography has three rows of three numbers, found 2
1 0 0/0 one 0/0 0 1 => line 2 of the homography must hold
1 0 0/0 1/0 0 1 => line 2 of the homography must hold
1 0 0 0/0 1 0/0 0 1 => line 1 of the homography must hold
1 0 0/0 1 0/0 0 1/0 0 1 => line 4 of the homography must hold
1 0 0/0 NaN 0/0 0 1 => row 2, column 2 of the homography
1 2 3/1 2 3/0 0 1 => the homography is singular
0 0 0/0 0 0/0 0 0 => the homography is singular
1e200 0 0/1e200 0 0/0 0 1 => the homography is singular
";
    for case in cases.lines().skip(1) {
        let (text, message) = case.split_once(" => ").unwrap();
        let error = text.replace('/', "\n").parse::<Homography>().unwrap_err();
        assert!(error.to_string().starts_with(message), "{case}: {error}");
    }
    let commas: Homography = "1,0,2\n\n0,1,3\n0,0,1\n".parse().unwrap();
    assert_eq!(commas.apply([1.0, 1.0]), Some([3.0, 4.0]));
}

#[test]
fn pixels_on_the_horizon_have_no_place() {
    let tilted: Homography = "1 0 0\n0 1 0\n0 -0.01 1".parse().unwrap();
    assert_eq!(tilted.apply([0.0, 100.0]), None);
    let plain: Homography = "1 0 0\n0 1 0\n0 0 1\n".parse().unwrap();
    assert_eq!(plain.apply([1e7, -1e7]), Some([1e7, -1e7]));
    assert_eq!([[1.1e7, 0.0], [0.0, -1.1e7]].map(|pixel| plain.apply(pixel)), [None; 2]);
    let recording = parse_recording(b"frame,pedestrian,x,y\n0,1,5,50\n1,1,5,100\n", "pixels", Format::Table).unwrap();
    let error = tilted.to_ground(&recording).unwrap_err().to_string();
    assert!(error.contains("pedestrian 1, frame 1"), "{error}");
}

proptest! {
    #[test]
    fn multiples_of_a_matrix_are_the_same_map(
        rows in prop::array::uniform3(prop::array::uniform3(-2.0..2.0_f64)),
        factor in prop_oneof![-9.0..-0.1_f64, 0.1..9.0_f64],
        pixel in prop::array::uniform2(-500.0..500.0_f64),
    ) {
        let Ok(one) = Homography::try_from(rows) else { return Ok(()) };
        let other = Homography::try_from(rows.map(|row| row.map(|entry| factor * entry))).unwrap();
        if let (Some(a), Some(b)) = (one.apply(pixel), other.apply(pixel)) {
            let far = 1.0 + a[0].hypot(a[1]);
            prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9 * far, "{a:?} {b:?}");
        }
    }
}
