/* Sampler: reads A0 exactly RATE times a second on an ATmega328P (Arduino Uno, 16 MHz) and sends each reading as a
 * frame. Wiring, protocol and how to put it on a board: ../README.md.
 *
 * Timer 1 starts every conversion in hardware (ADC auto trigger), so that the interval between samples does not depend on
 * what the program is doing. It is plain C and has its own main(), so the Arduino core's timers and Serial stay out of it.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdint.h>
#include <util/crc16.h>

#ifndef RATE
#define RATE 100 /* samples a second */
#endif
#define BAUD_RATE 115200
#define PRESCALER 8
#define TICKS (F_CPU / PRESCALER / RATE)

#if F_CPU % (PRESCALER * RATE) || TICKS > 65536
#error "RATE does not divide the clock exactly: choose one such as 50, 100, 125, 200, 250, 500, 1000"
#endif
#if RATE > 1000
#error "above 1000 samples a second the frames fill the line"
#endif

#define QUEUE 256 /* bytes waiting to be sent: 32 frames; the indices wrap by themselves */
static volatile uint8_t queue[QUEUE];
static volatile uint8_t head, tail;

static void put(uint8_t byte)
{
    queue[head++] = byte;
}

/* A conversion is done: one frame joins the queue. The sequence counts on where there is no room for it, so that the
 * loss shows. */
ISR(ADC_vect)
{
    static uint16_t sequence;
    uint16_t value = ADC;
    uint8_t body[4] = {(uint8_t)sequence, (uint8_t)(sequence >> 8), (uint8_t)value, (uint8_t)(value >> 8)};
    uint16_t crc = 0xFFFF;

    TIFR1 = _BV(OCF1B); /* a conversion starts when this flag rises: it has to be lowered */
    sequence++;
    if ((uint8_t)(head - tail) > QUEUE - 1 - 8)
        return;
    put(0xA5);
    put(0x5A);
    for (uint8_t i = 0; i < 4; i++) {
        put(body[i]);
        crc = _crc_xmodem_update(crc, body[i]);
    }
    put((uint8_t)crc);
    put((uint8_t)(crc >> 8));
    UCSR0B |= _BV(UDRIE0);
}

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
    UBRR0 = (F_CPU + 4UL * BAUD_RATE) / (8UL * BAUD_RATE) - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00); /* 8 data bits, no parity, 1 stop bit */
    UCSR0B = _BV(TXEN0);

    ADMUX = _BV(REFS0); /* A0 against AVcc, 5 V */
    DIDR0 = _BV(ADC0D);
    ADCSRB = _BV(ADTS2) | _BV(ADTS0); /* Timer 1, compare match B, starts a conversion */
    ADCSRA = _BV(ADEN) | _BV(ADATE) | _BV(ADIE) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0); /* 125 kHz */

    OCR1A = TICKS - 1;
    OCR1B = TICKS - 1;
    TCCR1A = 0;
    TCCR1B = _BV(WGM12) | _BV(CS11); /* count to OCR1A, clock / 8 */

    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;)
        sleep_mode();
}
