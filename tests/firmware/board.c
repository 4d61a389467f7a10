/* An emulated ATmega328P board: runs the real firmware in simavr, in real time, behind a pseudo-terminal.
 *
 *   board FIRMWARE.elf VOLTS TRUTH BOOT PORT [analog|encoder [AREF [HELD_UP]]]
 *
 * VOLTS holds lines "seconds volts", the voltage on A0 since the port was last opened (between the lines it is straight, beyond
 * them constant). TRUTH gets a line "reset sequence volts cycle host" for each conversion; host is the computer's clock (s), by
 * which the emulator may be late. BOOT is how long (s) the board is silent after the reset that opening the port causes; below 0
 * the board is not reset. PORT is the name that the port gets (a link).
 * With `encoder` VOLTS holds counts instead, which a quadrature encoder on D2 and D3 gives, and TRUTH the whole counts. AREF is the
 * voltage on that pin (5). HELD_UP seconds after a reset the emulator goes on as on a busy machine, 10 ms of each 30 ms: it falls
 * two seconds behind in three. SIGUSR1 reads VOLTS again, and its seconds begin anew. As on a real line, bytes are lost while nobody
 * has the port open or reads it.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "avr_adc.h"
#include "avr_ioport.h"
#include "avr_uart.h"
#include "sim_avr.h"
#include "sim_elf.h"
#include "sim_irq.h"

#define CLOCK 16000000UL
#define ADCSRB 0x7B          /* of the ATmega328P */
#define COMPARE_MATCH_B 5    /* in ADCSRB */
#define TIMER1_COMPB_VECTOR 12
#define EDGES 160            /* cycles between two looks at the encoder: 10 us */
#define BEFORE_RESET 0.03 /* s; what the board still sends when the port is opened */

static avr_t *avr;
static avr_irq_t *adc;
static int port, is_open;
static double *at, *volts;
static size_t points;
static FILE *truth;
static avr_cycle_count_t opened, powered;
static unsigned resets, conversions;
static uint32_t flag; /* OCF1B */
static int encoder, begun;
static long edges, start; /* of the encoder: by now, and when the board was reset */
static volatile sig_atomic_t another; /* VOLTS is to be read again */

static double voltage(double seconds)
{
    static size_t k;
    if (points == 0 || seconds <= at[0])
        return points ? volts[0] : 0;
    if (k >= points || at[k] > seconds)
        k = 0;
    while (k + 1 < points && at[k + 1] <= seconds)
        k++;
    if (k + 1 == points)
        return volts[k];
    return volts[k] + (volts[k + 1] - volts[k]) * (seconds - at[k]) / (at[k + 1] - at[k]);
}

static double moment(void)
{
    return is_open ? (double)(avr->cycle - opened) / CLOCK : 0;
}

/* How far (s) the emulator may be at a moment (s) after a reset. */
static double allowed(double moment, double held_up)
{
    return moment < held_up ? moment : held_up + 0.01 * floor((moment - held_up) / 0.03);
}

static double wall(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

static void on_conversion(avr_irq_t *irq, uint32_t value, void *param)
{
    double now = voltage(moment());
    (void)irq, (void)value, (void)param;
    /* simavr takes whole millivolts and sees 1023 steps in the reference, where the chip has 1024 */
    avr_raise_irq(adc + ADC_IRQ_ADC0, (uint32_t)ceil(1000 * now * 1024 / 1023));
    if (begun) /* the first is none of the samples */
        fprintf(truth, "%u %u %.6f %llu %.6f\n", resets, conversions++, now, (unsigned long long)avr->cycle, wall());
    begun = 1;
}

/* One edge at a time towards the counts that there are by now: A leads B while they grow. After a reset simavr takes the pull-ups
 * for the levels until they change: the first two edges may go uncounted. */
static avr_cycle_count_t on_turn(avr_t *which, avr_cycle_count_t when, void *param)
{
    static const uint8_t a[4] = {0, 1, 1, 0}, b[4] = {0, 0, 1, 1};
    long wanted = (long)floor(voltage(moment()));
    (void)which, (void)param;
    if (edges != wanted) {
        edges += edges < wanted ? 1 : -1;
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 2), a[edges & 3]);
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 3), b[edges & 3]);
    }
    return when + EDGES;
}

/* What simavr 1.6 lacks: Timer 1's compare match B starts a conversion when its flag (OCF1B) rises, and only then. */
static void on_match(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)param;
    if (value && !flag && encoder)
        fprintf(truth, "%u %u %ld %llu %.6f\n", resets, conversions++, edges - start, (unsigned long long)avr->cycle, wall());
    else if (value && !flag && (avr->data[ADCSRB] & 7) == COMPARE_MATCH_B)
        avr_raise_irq(adc + ADC_IRQ_IN_TRIGGER, 1);
    flag = value;
}

static uint8_t sent[65536]; /* as much as Linux keeps of a serial port that is not read in time */
static size_t waiting;

static void on_byte(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)param;
    if (is_open && waiting < sizeof sent)
        sent[waiting++] = (uint8_t)value;
}

/* What was sent of late; what does not fit because nobody reads is lost. */
static void deliver(void)
{
    if (waiting)
        fflush(truth); /* it is never behind what was sent, also where the board is unplugged */
    ssize_t done = is_open ? write(port, sent, waiting) : (ssize_t)waiting;
    if (done > 0) {
        waiting -= (size_t)done;
        memmove(sent, sent + done, waiting);
    }
}

static void no_sleep(avr_t *which, avr_cycle_count_t cycles)
{
    (void)which, (void)cycles;
}

static void read_volts(const char *path)
{
    FILE *file = fopen(path, "r");
    double t, v;
    if (!file)
        exit((perror(path), 1));
    points = 0;
    while (fscanf(file, "%lf %lf", &t, &v) == 2) {
        at = realloc(at, (points + 1) * sizeof *at);
        volts = realloc(volts, (points + 1) * sizeof *volts);
        at[points] = t, volts[points++] = v;
    }
    fclose(file);
}

static void on_hands(int number)
{
    (void)number;
    another = 1;
}

static void power_on(const char *elf, double aref)
{
    elf_firmware_t firmware = {0};
    uint32_t flags = 0;
    if (elf_read_firmware(elf, &firmware) || !(avr = avr_make_mcu_by_name("atmega328p")))
        exit((fprintf(stderr, "%s cannot be loaded\n", elf), 1));
    avr_init(avr);
    firmware.frequency = CLOCK;
    firmware.vcc = firmware.avcc = 5000;
    firmware.aref = (uint32_t)(1000 * aref);
    avr_load_firmware(avr, &firmware);
    avr->sleep = no_sleep;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~AVR_UART_FLAG_STDIO;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    adc = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, 0);
    avr_irq_register_notify(adc + ADC_IRQ_OUT_TRIGGER, on_conversion, NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, TIMER1_COMPB_VECTOR), on_match, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_byte, NULL);
}

int main(int argc, char **argv)
{
    struct termios raw;
    int slave;
    char name[128];
    double boot, began, held_up, reset_at = -1, silent_until = -1, reset_done = 0;

    if (argc < 6 || argc > 9)
        return fprintf(stderr, "usage: board FIRMWARE.elf VOLTS TRUTH BOOT PORT [analog|encoder [AREF [HELD_UP]]]\n"), 2;
    encoder = argc > 6 && !strcmp(argv[6], "encoder");
    read_volts(argv[2]);
    signal(SIGUSR1, on_hands);
    if (!(truth = fopen(argv[3], "w")))
        return perror(argv[3]), 1;
    boot = atof(argv[4]);
    power_on(argv[1], argc > 7 ? atof(argv[7]) : 5);
    held_up = argc > 8 ? atof(argv[8]) : INFINITY;

    if (openpty(&port, &slave, name, NULL, NULL))
        return perror("openpty"), 1;
    tcgetattr(slave, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave, TCSANOW, &raw);
    close(slave); /* the master now tells by POLLHUP whether anyone has the port open */
    fcntl(port, F_SETFL, O_NONBLOCK);
    unlink(argv[5]);
    if (symlink(name, argv[5]))
        return perror(argv[5]), 1;

    began = wall();
    for (;;) {
        double now = wall() - began;
        struct pollfd state = {.fd = port};
        if (another) {
            another = 0;
            read_volts(argv[2]);
            opened = avr->cycle;
        }
        poll(&state, 1, 0);
        if (is_open != ((state.revents & POLLHUP) == 0)) {
            is_open = !is_open;
            opened = avr->cycle;
            reset_at = is_open && boot >= 0 ? now + BEFORE_RESET : -1;
            silent_until = -1;
        }
        if (reset_at >= 0 && now >= reset_at) {
            reset_at = -1, silent_until = now + boot;
        }
        if (silent_until >= 0 && now < silent_until) {
            avr->cycle = (avr_cycle_count_t)(now * CLOCK);
        } else {
            if (silent_until >= 0) {
                silent_until = -1, reset_done = now;
                avr_reset(avr);
                powered = avr->cycle;
                resets++, conversions = 0;
                begun = 0, flag = 0;
                if (encoder) {
                    edges = start = (long)floor(voltage(moment()));
                    start = edges &= ~3L; /* both pins low, as they are in the emulator after a reset */
                    avr_cycle_timer_register(avr, 10 * EDGES, on_turn, NULL);
                }
            }
            /* Held up by a busy machine, it catches up 4 ms at a time: no board sends seconds in one burst. */
            double until = fmin((reset_done + allowed(now - reset_done, held_up)) * CLOCK, avr->cycle + 0.004 * CLOCK);
            while (avr->cycle < until) {
                int is = avr_run(avr);
                if (is == cpu_Done || is == cpu_Crashed)
                    return fprintf(stderr, "the firmware %s at %#x after %u resets, %llu cycles\n", is == cpu_Done ? "slept for ever" : "crashed", avr->pc, resets, (unsigned long long)(avr->cycle - powered)), 1;
            }
            deliver();
        }
        nanosleep(&(struct timespec){.tv_nsec = 500000}, NULL);
    }
}
