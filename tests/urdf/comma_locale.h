/* comma_locale.h - decimal commas for the process, and back. */
#ifdef __cplusplus
extern "C" {
#endif
void comma_locale(void);
void classic_locale(void);
#ifdef __cplusplus
}
#endif
