// The helper's own cases: 1 is a misuse, 2 compiles though it is called a misuse, 3 has a twin that does not compile.
[[nodiscard]] int verdict();

int caller() {
#if CASE == 1 && !defined(CASE_OK)
  verdict();
  return 0;
#elif CASE == 3
  return missing();
#else
  return verdict();
#endif
}
