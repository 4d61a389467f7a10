/* Sampler: reads A0, or counts a quadrature encoder, and sends RATE samples a second from an ATmega328P (Arduino Uno or Nano,
 * 16 MHz), each as a frame. Wiring, protocol and how to put it on a board: ../README.md.
 *
 * Timer 1 starts every conversion in hardware (ADC auto trigger), so that the interval between samples does not depend on
 * what the program is doing. It is plain C and has its own main(), so the Arduino core's timers and Serial stay out of it.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdint.h>
#include <util/crc16.h>

/* What may be chosen, here or with -D: */
#ifndef RATE
#define RATE 100 /* samples a second */
#endif
#ifndef OVERSAMPLE
#define OVERSAMPLE 1 /* readings of A0, evenly spread over the interval, whose sum is one sample: 1 to 64 */
#endif
#ifndef EXTERNAL_REFERENCE
#define EXTERNAL_REFERENCE 0 /* 1: the converter's reference is what is wired to the pin AREF, not the board's 5 V */
#endif
#ifndef ENCODER
#define ENCODER 0 /* 1: count a quadrature encoder on D2 and D3 instead of reading A0 */
#endif
#ifndef BAUD_RATE
#define BAUD_RATE 250000 /* bits a second */
#endif

#if !defined(__AVR_ATmega328P__) && !defined(__AVR_ATmega328__)
#error "this sampler serves the ATmega328P alone (Arduino Uno, Nano, Pro Mini): on a Mega, a Leonardo or a newer Nano its interrupts have other names and the board would reset for ever"
#endif

#define FRAME (ENCODER ? 10 : 8) /* bytes */
#define PRESCALER 8
#define READINGS (ENCODER ? 1 : OVERSAMPLE)
#define TICKS (F_CPU / PRESCALER / RATE / READINGS)
#define DIVISOR ((F_CPU + 4L * BAUD_RATE) / (8L * BAUD_RATE))

#if F_CPU % (PRESCALER * RATE * READINGS) || TICKS > 65536
#error "RATE (times OVERSAMPLE) does not divide the clock exactly: choose a rate such as 50, 100, 125, 200, 250, 500, 1000, 5000"
#endif
#if OVERSAMPLE < 1 || OVERSAMPLE > 64
#error "OVERSAMPLE is 1 to 64: more readings do not fit into the 16 bits of a sample"
#endif
#if RATE * READINGS > 8000
#error "the converter takes 8000 readings a second at most: lower RATE or OVERSAMPLE"
#endif
#if RATE * FRAME * 10 > BAUD_RATE / 10 * 9
#error "the frames fill the line: raise BAUD_RATE (250000, 500000 and 1000000 are exact) or lower RATE"
#endif
#if 8000 * DIVISOR * BAUD_RATE > 1005 * F_CPU || 8000 * DIVISOR * BAUD_RATE < 995 * F_CPU
#error "the clock cannot make this BAUD_RATE within 0.5 %: choose 38400, 250000, 500000 or 1000000"
#endif

#define QUEUE 256 /* bytes waiting to be sent; the indices wrap by themselves */
static volatile uint8_t queue[QUEUE];
static volatile uint8_t head, tail;
static uint16_t sequence;

static void put(uint8_t byte)
{
    queue[head++] = byte;
}

/* One frame joins the queue: the sequence number and `size` bytes of the value. The sequence counts on where there is no room
 * for it, so that the loss shows. */
static void send(uint8_t kind, uint32_t value, uint8_t size)
{
    uint8_t body[6] = {(uint8_t)sequence, (uint8_t)(sequence >> 8), (uint8_t)value, (uint8_t)(value >> 8),
                       (uint8_t)(value >> 16), (uint8_t)(value >> 24)};
    uint16_t crc = 0xFFFF;

    sequence++;
    if ((uint8_t)(head - tail) > QUEUE - 1 - FRAME)
        return;
    put(0xA5);
    put(kind);
    for (uint8_t i = 0; i < 2 + size; i++) {
        put(body[i]);
        crc = _crc_xmodem_update(crc, body[i]);
    }
    put((uint8_t)crc);
    put((uint8_t)(crc >> 8));
    UCSR0B |= _BV(UDRIE0);
}

#if ENCODER
static volatile int32_t count;
static volatile uint8_t pins, missed;

/* A or B has changed: one count forward or back, by what they were and what they are. Both at once is a step too fast to be
 * told from one back: a sequence number is left out for it, so that it shows as a loss. */
static void step(void)
{
    static const int8_t way[16] = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};
    uint8_t now = (PIND >> 2) & 3;
    int8_t by = way[pins << 2 | now];

    pins = now;
    if (by == 2)
        missed = 1;
    else
        count += by;
}

ISR(INT0_vect)
{
    step();
}

ISR(INT1_vect)
{
    step();
}

ISR(TIMER1_COMPB_vect)
{
    int32_t now = count;

    if (sequence) /* before the first sample nothing is missed */
        sequence += missed;
    missed = 0;
    sei(); /* the encoder does not wait while the frame is made */
    send(0x5C, (uint32_t)now, 4);
}

static void begin(void)
{
    PORTD |= _BV(PORTD2) | _BV(PORTD3); /* pull-ups, for encoders with open collectors */
    pins = (PIND >> 2) & 3;
    EICRA = _BV(ISC00) | _BV(ISC10); /* any change of D2 and of D3 */
    EIMSK = _BV(INT0) | _BV(INT1);
    TIMSK1 = _BV(OCIE1B);
}
#else
/* A conversion is done. A sample of which one reading lay at an end of the converter's range is sent as that end: the true
 * mean is not known. */
ISR(ADC_vect)
{
    static uint16_t sum;
    static uint8_t begun, readings, low, high;
    uint16_t value = ADC;

    TIFR1 = _BV(OCF1B); /* a conversion starts when this flag rises: it has to be lowered */
    if (!begun) {       /* the very first takes twice as long, and may miss the next start */
        begun = 1;
        return;
    }
    sum += value;
    low |= value == 0;
    high |= value == 1023;
    if (++readings < OVERSAMPLE)
        return;
    if (high)
        sum = 1023U * OVERSAMPLE;
    else if (low)
        sum = 0;
    send(0x5A, sum, 2);
    sum = 0;
    readings = low = high = 0;
}

static void begin(void)
{
    ADMUX = EXTERNAL_REFERENCE ? 0 : _BV(REFS0); /* A0 against AREF, or against AVcc, 5 V */
    DIDR0 = _BV(ADC0D);
    ADCSRB = _BV(ADTS2) | _BV(ADTS0); /* Timer 1, compare match B, starts a conversion */
    ADCSRA = _BV(ADEN) | _BV(ADATE) | _BV(ADIE) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0); /* 125 kHz */
}
#endif

/* The line takes the next byte. */
ISR(USART_UDRE_vect)
{
    if (head == tail)
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
    else
        UDR0 = queue[tail++];
}

int main(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = DIVISOR - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00); /* 8 data bits, no parity, 1 stop bit */
    UCSR0B = _BV(TXEN0);

    begin();
    OCR1A = TICKS - 1;
    OCR1B = TICKS - 1;
    TCCR1A = 0;
    TCCR1B = _BV(WGM12) | _BV(CS11); /* count to OCR1A, clock / 8 */

    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;)
        sleep_mode();
}
