!> Parabolic fibres: the layers of a composite shell of the calculix dialect move as one solid of 20 or 15 nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! CalculiX has one solid for all layers: over the whole thickness its displacement is a parabola. Here each layer has a solid,
!! whose nodes between top and bottom follow those of the one solid. With the place p of a node, 0 at the bottom and 1 on top:
!!
!! - at a corner: the parabola through bottom b, top t and the inner node nearest to the middle, which stays free;
!! - at the middle of a side, where the one solid has no inner node: (1 - p) b + p t + p (1 - p) sum (2 m - b - t) over both corners
!!   of the side, m the middle of their fibre. These are the shape functions of both solids on that side.
!!
!! The functions of a solid of 20 nodes are the products of powers of x, y, z of superlinear degree up to 2; those of one of 15
!! nodes are quadratic in the triangle times linear in z, and linear times z^2. Both sets are closed under z -> a + b z. So the
!! solid of a layer whose nodes lie on these fibres has exactly the displacement of the one solid, and its points are CalculiX's.
!! Source: D. N. Arnold, G. Awanou, The serendipity family of finite elements, Found. Comput. Math. 11 (2011) 337-344, section 2.
module amontons_parabolic_fibres
  use amontons_kinds, only: DP
  use amontons_loads, only: equation_type
  use amontons_model, only: new_equation
  use amontons_structural_data, only: structure_type, director_type, middle_node, parabola_weights
  implicit none
  private
  public :: add_parabolic_fibres

contains

  !> The equations of the inner nodes of all parabolic fibres.
  subroutine add_parabolic_fibres(structure, equations, n)
    type(structure_type), intent(in) :: structure
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer, allocatable :: corners(:, :)
    integer :: i
    if (.not. any(structure%directors%is_parabolic)) return
    call find_corners(structure, corners)
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        if (.not. director%is_parabolic) cycle
        if (middle_node(director) > 0) then
          call add_corner(structure, director, equations, n)
        else
          call add_side(structure, director, structure%directors(corners(:, i)), equations, n)
        end if
      end associate
    end do
  end subroutine add_parabolic_fibres


  !> The directors at both corners of the side in whose middle a parabolic director is. Where these corners are knots, elements may
  !! have different ones: their fibres are straight then, and each gives the same equation.
  pure subroutine find_corners(structure, corners)
    type(structure_type), intent(in) :: structure
    integer, allocatable, intent(out) :: corners(:, :)   !< (2, directors); 0: at a corner
    integer :: e, i, n
    allocate (corners(2, size(structure%directors)), source=0)
    do e = 1, size(structure%section)
      if (structure%section(e) == 0) cycle
      associate (of => structure%director_of(structure%first(e):structure%first(e + 1) - 1))
        if (.not. structure%directors(of(1))%is_one_solid) cycle
        n = size(of) / 2
        do i = 1, n
          corners(:, of(n + i)) = [of(i), of(modulo(i, n) + 1)]
        end do
      end associate
    end do
  end subroutine find_corners


  !> At a corner.
  subroutine add_corner(structure, director, equations, n)
    type(structure_type), intent(in) :: structure
    type(director_type), intent(in) :: director
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer :: i, k, middle
    middle = middle_node(director)
    associate (section => structure%sections(director%section))
      do i = 3, size(director%nodes)
        if (i == middle) cycle
        do k = 1, 3
          n = n + 1
          equations(n) = new_equation(director%nodes([i, 1, 2, middle]), [k, k, k, k], &
            [1.0_DP, -parabola_weights(director, director%place(i))], section%card, section%line)
        end do
      end do
    end associate
  end subroutine add_corner


  !> In the middle of a side.
  subroutine add_side(structure, director, corners, equations, n)
    type(structure_type), intent(in) :: structure
    type(director_type), intent(in) :: director
    type(director_type), intent(in) :: corners(2)   !< of the side
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer :: nodes(6), c, i, k
    real(DP) :: bulge(6), p
    do c = 1, 2
      nodes(3 * c - 2:3 * c) = corners(c)%nodes([1, 2, middle_node(corners(c))])
      bulge(3 * c - 2:3 * c) = 2 * parabola_weights(corners(c), 0.5_DP) - [1.0_DP, 1.0_DP, 0.0_DP]
    end do
    associate (section => structure%sections(director%section))
      do i = 3, size(director%nodes)
        p = director%place(i)
        do k = 1, 3
          n = n + 1
          equations(n) = new_equation([director%nodes([i, 1, 2]), nodes], spread(k, 1, 9), [1.0_DP, p - 1, -p, &
            -p * (1 - p) * bulge], section%card, section%line)
        end do
      end do
    end associate
  end subroutine add_side

end module amontons_parabolic_fibres
