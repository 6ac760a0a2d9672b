!> Separation of two faces in the frame of their middle surface, with its first and second derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The middle surface has the tangents f1, f2 along two directions of the reference configuration, and d is the vector from one face
!! to the other. The frame is e1 = f1/|f1|, n = f1 x f2/|f1 x f2|, e2 = n x e1, so that the components
!!
!!     d.n = (f1 x f2).d/J,   d.e1 = s1/c,   d.e2 = (s2 c11 - s1 c12)/(J c),   s_i = f_i.d, c_ij = f_i.f_j, c^2 = c11,
!!
!! J^2 = c11 c22 - c12^2, do not change with a rotation of all three vectors. They are evaluated in truncated Taylor series, whose
!! product rule gives both derivatives exactly. Theory: doc/theory/cohesion.md.
module amontons_face_separation
  use amontons_kinds, only: DP
  implicit none
  private
  public :: separation_type, evaluate_separation, N_VARIABLES

  integer, parameter :: N_VARIABLES = 9          !< f1, f2, d

  !> A scalar with its derivatives by the variables.
  type :: series_type
    real(DP) :: value = 0
    real(DP) :: slope(N_VARIABLES) = 0
    real(DP) :: curvature(N_VARIABLES, N_VARIABLES) = 0
  end type series_type

  !> The three components: normal, first and second shear.
  type :: separation_type
    real(DP) :: value(3) = 0                       !< [length]
    real(DP) :: slope(N_VARIABLES, 3) = 0
    real(DP) :: curvature(N_VARIABLES, N_VARIABLES, 3) = 0
  end type separation_type

  interface operator(*)
    module procedure product_of
  end interface
  interface operator(+)
    module procedure sum_of
  end interface
  interface operator(-)
    module procedure difference_of
  end interface

contains

  !> The components of the vector between two faces. Not to be called with f1 and f2 along one line.
  pure function evaluate_separation(f1, f2, d) result(separation)
    real(DP), intent(in) :: f1(3), f2(3)           !< tangents of the middle surface [-]
    real(DP), intent(in) :: d(3)                   !< from the first face to the second [length]
    type(separation_type) :: separation
    type(series_type) :: a(3), b(3), c(3), c11, c12, inverse_J, s1, part
    integer :: i
    do i = 1, 3
      a(i) = variable(i, f1(i))
      b(i) = variable(3 + i, f2(i))
      c(i) = variable(6 + i, d(i))
    end do
    c11 = scalar_product(a, a)
    c12 = scalar_product(a, b)
    s1 = scalar_product(a, c)
    inverse_J = power(c11 * scalar_product(b, b) - c12 * c12, -0.5_DP)
    part = c(1) * (a(2) * b(3) - a(3) * b(2)) + c(2) * (a(3) * b(1) - a(1) * b(3)) + c(3) * (a(1) * b(2) - a(2) * b(1))
    call store(1, part * inverse_J)
    call store(2, s1 * power(c11, -0.5_DP))
    part = scalar_product(b, c) * c11 - s1 * c12
    call store(3, part * inverse_J * power(c11, -0.5_DP))

  contains

    !> Puts a component into the result.
    pure subroutine store(i, component)
      integer, intent(in) :: i
      type(series_type), intent(in) :: component
      separation%value(i) = component%value
      separation%slope(:, i) = component%slope
      separation%curvature(:, :, i) = component%curvature
    end subroutine store

  end function evaluate_separation


  !> A variable.
  pure function variable(i, value) result(x)
    integer, intent(in) :: i
    real(DP), intent(in) :: value
    type(series_type) :: x
    x%value = value
    x%slope(i) = 1
  end function variable


  !> a.b
  pure function scalar_product(a, b) result(c)
    type(series_type), intent(in) :: a(3), b(3)
    type(series_type) :: c
    c = a(1) * b(1) + a(2) * b(2) + a(3) * b(3)
  end function scalar_product


  !> a b
  elemental function product_of(a, b) result(c)
    type(series_type), intent(in) :: a, b
    type(series_type) :: c
    integer :: j
    c%value = a%value * b%value
    c%slope = a%value * b%slope + b%value * a%slope
    do j = 1, N_VARIABLES
      c%curvature(:, j) = a%value * b%curvature(:, j) + b%value * a%curvature(:, j) + a%slope(j) * b%slope + b%slope(j) * a%slope
    end do
  end function product_of


  !> a + b
  elemental function sum_of(a, b) result(c)
    type(series_type), intent(in) :: a, b
    type(series_type) :: c
    c = series_type(a%value + b%value, a%slope + b%slope, a%curvature + b%curvature)
  end function sum_of


  !> a - b
  elemental function difference_of(a, b) result(c)
    type(series_type), intent(in) :: a, b
    type(series_type) :: c
    c = series_type(a%value - b%value, a%slope - b%slope, a%curvature - b%curvature)
  end function difference_of


  !> a to a power.
  pure function power(a, exponent) result(c)
    type(series_type), intent(in) :: a             !< positive
    real(DP), intent(in) :: exponent
    type(series_type) :: c
    real(DP) :: first, second
    integer :: j
    first = exponent * a%value**(exponent - 1)
    second = exponent * (exponent - 1) * a%value**(exponent - 2)
    c%value = a%value**exponent
    c%slope = first * a%slope
    do j = 1, N_VARIABLES
      c%curvature(:, j) = first * a%curvature(:, j) + second * a%slope(j) * a%slope
    end do
  end function power

end module amontons_face_separation
