// What test_lanes.cpp asks of each vector level: compiled once for each of them.
// No guard and no includes: see strainwave/lanes_each_level.hpp.

/// Functions of lanes over arrays, a register at a time; sizes are whole registers.
template <class Real>
void cos_sin_of_array(const Real* angle_rad, std::size_t size, Real* cosine, Real* sine) {
  for (std::size_t i = 0; i < size; i += Lanes<Real>::count) {
    const CosSin<Lanes<Real>> wave = cos_sin_of_radians(Lanes<Real>::load(angle_rad + i));
    wave.cosine.store(cosine + i);
    wave.sine.store(sine + i);
  }
}

template <class Real>
void cos_sin_of_small(const Real* angle_rad, std::size_t size, Real* cosine, Real* sine) {
  for (std::size_t i = 0; i < size; i += Lanes<Real>::count) {
    const CosSin<Lanes<Real>> wave = cos_sin_small(Lanes<Real>::load(angle_rad + i));
    wave.cosine.store(cosine + i);
    wave.sine.store(sine + i);
  }
}

/// The larger of both where the first is not below the second, the square root of the first's
/// magnitude elsewhere: comparison, selection and the rest in one.
template <class Real>
void chosen_of_arrays(const Real* a, const Real* b, std::size_t size, Real* result) {
  for (std::size_t i = 0; i < size; i += Lanes<Real>::count) {
    const Lanes<Real> first = Lanes<Real>::load(a + i);
    const Lanes<Real> second = Lanes<Real>::load(b + i);
    const LaneMask<Real> chosen = !(first < second);
    select(chosen, larger(first, second), square_root(absolute(first))).store(result + i);
  }
}

/// Whether any and all of the numbers of each register are below a limit: 2 bits a register.
template <class Real>
void asked_of_array(const Real* a, std::size_t size, Real limit, int* answers) {
  for (std::size_t i = 0; i < size; i += Lanes<Real>::count) {
    const LaneMask<Real> below = Lanes<Real>::load(a + i) < Lanes<Real>(limit);
    for (std::size_t lane = i; lane < i + Lanes<Real>::count; ++lane) {
      answers[lane] = (below.any() ? 1 : 0) + (below.all() ? 2 : 0);
    }
  }
}

/// How many numbers a register holds.
template <class Real>
std::size_t count_of_lanes() {
  return Lanes<Real>::count;
}
