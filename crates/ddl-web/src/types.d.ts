/** Options by the names of the program's (`ddl forecast --help`). */
export interface Options {
  /** Frame numbers per second; one of `fps`, `dt`, `frameStep`. Default: that of the file, or guessed and noted. */
  fps?: number;
  /** Seconds between consecutive frame numbers. */
  dt?: number;
  /** Frame numbers in 0.4 s. */
  frameStep?: number;
  /** Positions are in pixels: the homography to metres as text, three lines of three numbers. */
  homography?: string;
  /** The columns of a table where their names do not say it, such as `frame=frame_id,x=xCenter`. */
  columns?: string;
  /** Only rows with this value, such as `class=Pedestrian`. */
  keep?: string;
  /** The unit of positions. Default: that in the names of the columns, or m. */
  unit?: "m" | "cm" | "mm" | "px";
  /** Only pedestrians tracked for all 8 observed steps. */
  whole?: boolean;
  /** Carry pedestrians on until their last row is so old, seconds. */
  maxAge?: number;
  /** Time between two forecasts, seconds. Default: every frame, or 0.4 s if each pedestrian has a clock of its own. */
  every?: number;
  /** Only the last moment. */
  last?: boolean;
  /** Joint futures of all pedestrians instead of hypotheses of each. */
  joint?: boolean;
  /** Probabilities of regions, such as [0.5, 0.9]. */
  region?: number[];
  /** Forecasts use the paths of earlier pedestrians of the place. */
  memory?: boolean;
  /** Moments of `view`, evenly spread. Default: 60. */
  moments?: number;
}

/** Options of `Live`; those of files are refused there. */
export type LiveOptions = Pick<
  Options,
  "fps" | "dt" | "frameStep" | "whole" | "maxAge" | "every" | "joint" | "region" | "memory"
>;

/** [x, y], metres. */
export type Position = [number, number];
/** A frame number, a time in the unit of the file, or a date. */
export type FrameNumber = number | string;

export interface ObservedPedestrian {
  pedestrian: number | string;
  /** Positions, of 8, before its first row; they were estimated. */
  unseen: number;
  /** Time since its last row, seconds. */
  age: number;
  /** What the observation adds to the error at the end of the forecast, metres. */
  uncertainty: number;
  /** Share of training motions that are at least as unusual, 0 to 1. */
  familiarity?: number;
  /** Scale of the error around the right hypothesis at each of the 12 steps, metres. */
  spread?: number[];
  regions?: {
    probability: number;
    /** Of each of the 12 steps: discs of x, y and radius, metres. */
    discs: [number, number, number][][];
  }[];
}

export interface Path {
  goal: Position | null;
  /** 12 positions, 0.4 s apart. */
  positions: Position[];
}

/** The 20 hypotheses of one pedestrian at one moment. */
export interface PedestrianForecast extends ObservedPedestrian {
  observed_until: FrameNumber;
  /** The frames of the 12 positions. */
  frames: FrameNumber[];
  hypotheses: (Path & { weight: number })[];
}

/** The 20 joint futures of one moment. */
export interface SceneForecast {
  observed_until: FrameNumber;
  frames: FrameNumber[];
  pedestrians: ObservedPedestrian[];
  /** Who walks together. */
  groups: (number | string)[][];
  /** Each with one path for each pedestrian, in their order. */
  futures: { weight: number; paths: Path[] }[];
}

export interface Answer {
  /** False where `Live` has not forecast, because `every` seconds are not over: the last forecasts stay valid. */
  due: boolean;
  /** What is assumed, left out or doubted, a line each. */
  notes: string[];
  /** `SceneForecast` with `joint`, else `PedestrianForecast`: the objects of `ddl forecast --format jsonl`. */
  forecasts: (PedestrianForecast | SceneForecast)[];
}

export interface View {
  /** The recording as `ddl data --json` describes it: numbers of pedestrians, frames, seconds, and more. */
  data: Record<string, any>;
  /** An HTML page that plays the forecasts. */
  page: string;
  /** Where pedestrians walk, appear and disappear, as SVG. */
  place: string;
  notes: string[];
  /** The forecasts of the page as the program's JSON lines. */
  lines: string;
}
