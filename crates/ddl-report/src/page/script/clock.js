// The time of the player, in frames from 0 to 19. It runs at twice real time, or frame by frame if the system asks for
// reduced motion.

const SPEED = 2;
const PAUSE_AT_END = 1.2;

function makeClock(onTime, onPlaying) {
  const reduced = matchMedia("(prefers-reduced-motion: reduce)");
  let time = OBSERVED - 1;
  let playing = false;
  let last = 0;
  let rest = 0;

  function tick(now) {
    if (!playing) return;
    // The first picture may have started before the clock; a long pause must not cause a leap.
    const seconds = Math.min(Math.max((now - last) / 1000, 0), 0.25);
    last = now;
    if (rest > 0) {
      rest -= seconds;
      if (rest <= 0) time = 0;
    } else {
      time += (SPEED * seconds) / SECONDS_A_FRAME;
      if (time >= FRAMES - 1) {
        time = FRAMES - 1;
        rest = PAUSE_AT_END;
      }
    }
    onTime(reduced.matches ? Math.floor(time) : time);
    requestAnimationFrame(tick);
  }

  function set(to) {
    time = Math.min(Math.max(to, 0), FRAMES - 1);
    rest = 0;
    onTime(time);
  }

  function play(on) {
    if (on === playing) return;
    playing = on;
    if (playing) {
      if (time >= FRAMES - 1) time = 0;
      rest = 0;
      last = performance.now();
      requestAnimationFrame(tick);
    } else {
      onTime(reduced.matches ? Math.floor(time) : time);
    }
    onPlaying(playing);
  }

  return {
    set,
    play,
    toggle: () => play(!playing),
    // Moves to a whole frame and stops.
    step: (by) => {
      play(false);
      set(by > 0 ? Math.floor(time + 1e-9) + by : Math.ceil(time - 1e-9) + by);
    },
    time: () => time,
  };
}
