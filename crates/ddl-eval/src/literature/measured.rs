//! What forecasters without a model reach.

use super::MeasuredRow;

/// Baselines on all test windows of the `star` convention, cut by the published rule.
///
/// The rows on goals were measured with the published estimator (100 experts, 20 centres, gamma = 1).
pub const MEASURED: [MeasuredRow; 12] = [
    MeasuredRow {
        method: "constant velocity (last step)",
        remark: "",
        ade: Some([0.677, 0.325, 0.525, 0.428, 0.324]),
        fde: [1.341, 0.615, 1.166, 0.953, 0.724],
    },
    MeasuredRow {
        method: "constant velocity (mean observed)",
        remark: "",
        ade: Some([0.575, 0.225, 0.676, 0.553, 0.421]),
        fde: [1.159, 0.420, 1.371, 1.134, 0.859],
    },
    MeasuredRow {
        method: "constant velocity, 25 degree angular noise, best of 20",
        remark: "",
        ade: Some([0.492, 0.252, 0.388, 0.304, 0.226]),
        fde: [0.924, 0.473, 0.817, 0.619, 0.476],
    },
    MeasuredRow {
        method: "constant acceleration",
        remark: "",
        ade: Some([3.924, 1.968, 1.068, 0.892, 0.642]),
        fde: [9.777, 4.900, 2.668, 2.215, 1.617],
    },
    MeasuredRow {
        method: "constant acceleration (bounded)",
        remark: "",
        ade: Some([1.928, 0.763, 0.648, 0.644, 0.446]),
        fde: [4.027, 1.556, 1.436, 1.475, 1.029],
    },
    MeasuredRow {
        method: "social force",
        remark: "",
        ade: Some([0.724, 0.339, 0.695, 0.514, 0.401]),
        fde: [1.379, 0.627, 1.380, 1.061, 0.825],
    },
    MeasuredRow {
        method: "straight line to the TRUE end",
        remark: "reads the true end",
        ade: Some([0.190, 0.073, 0.187, 0.152, 0.118]),
        fde: [0.0; 5],
    },
    MeasuredRow {
        method: "goal nearest the true end, of 20 (goal FDE)",
        remark: "goal query reads one future frame",
        ade: None,
        fde: [0.548, 0.375, 0.622, 0.326, 0.248],
    },
    MeasuredRow {
        method: "the same, observed frames only (goal FDE)",
        remark: "univ on a twelfth and zara2 on a third of the walkers",
        ade: None,
        fde: [0.584, 0.384, 0.644, 0.354, 0.277],
    },
    MeasuredRow {
        method: "nearest of all 100 retrieved ends (goal FDE)",
        remark: "goal query reads one future frame",
        ade: None,
        fde: [0.422, 0.283, 0.528, 0.215, 0.179],
    },
    MeasuredRow {
        method: "straight lines to the 20 published goals (minADE/FDE of that line)",
        remark: "goal query reads one future frame",
        ade: Some([0.330, 0.222, 0.357, 0.208, 0.153]),
        fde: [0.628, 0.392, 0.698, 0.409, 0.312],
    },
    MeasuredRow {
        method: "straight line to the goal nearest the true end",
        remark: "chooses the goal with the true end; goal query reads one future frame",
        ade: Some([0.362, 0.229, 0.388, 0.240, 0.178]),
        fde: [0.548, 0.375, 0.622, 0.326, 0.248],
    },
];
