; yosys-smt2-module trial
(declare-sort |trial_s| 0)
(declare-fun |trial_is| (|trial_s|) Bool)
; yosys-smt2-assert 0 trial trial
(define-fun |trial_a 0| ((state |trial_s|)) Bool false)
(define-fun |trial_a| ((state |trial_s|)) Bool (|trial_a 0| state))
(define-fun |trial_u| ((state |trial_s|)) Bool true)
(define-fun |trial_i| ((state |trial_s|)) Bool true)
(define-fun |trial_h| ((state |trial_s|)) Bool true)
(define-fun |trial_t| ((state |trial_s|) (next_state |trial_s|)) Bool true)
; yosys-smt2-topmod trial
