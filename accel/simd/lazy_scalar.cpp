#include <rayloom/accel/lazy-inl.h>
